# SPDX-License-Identifier: GPL-3.0-or-later
"""Mistakes in the files of a block of images, each named by one message, and nothing written."""
import csv
import math
import sys
import unittest

from support import SOURCE, Case, swath

sys.path.insert(0, str(SOURCE / "bench" / "block"))
from blocks import Block, Camera  # noqa: E402


def write(folder, angles=0.01, control=True, camera=Camera(50.0), images=5, **options):
    """Three strips of images flown to and fro, five control points."""
    base, apart = 0.4 * 900.0 * camera.columns * camera.pixel / 50.0, 0.6 * 900.0 * camera.rows * camera.pixel / 50.0
    last = images - 1
    block = Block(3, camera, [(0 if k % 2 == 0 else last * base, k * apart, 90 if k % 2 == 0 else 270, images, base, 900.0) for k in range(3)])
    block.grid(0.4 * base, 0.3 * base)
    names = [f"c{k}" for k in range(5)]
    for name, (x, y) in zip(names, ((0.2, 0), (last - 0.2, 0), (0.2, 2), (last - 0.2, 2), (last / 2, 1))):
        block.add(name, x * base, y * apart)
    block.write(folder, 0.0027, stations=0.1, angles=angles, control=names if control else None, **options)


def change(file, edit):
    """`edit` takes the rows as dictionaries and changes or returns them."""
    with open(file) as f:
        reader = csv.DictReader(f)
        columns, rows = reader.fieldnames, list(reader)
    rows = edit(rows) or rows
    file.write_text("\n".join([",".join(columns), *(",".join(str(r[c]) for c in columns) for r in rows)]) + "\n")


def scale(**factors):
    def edit(rows):
        for r in rows:
            for column, factor in factors.items():
                r[column] = factor * float(r[column])
    return edit


def exchange(a, b):
    def edit(rows):
        for r in rows:
            r[a], r[b] = r[b], r[a]
    return edit


def next_station(strip, first):
    """From an image of a strip on: position and angles are those of the next image."""
    def edit(rows):
        of = [r for r in rows if r["strip"] == strip]
        columns = list(of[0])[3:]
        values = [[float(r[c]) for c in columns] for r in of] + [[2 * float(of[-1][c]) - float(of[-2][c]) for c in columns]]
        values[-1][3:] = values[-2][3:]
        for k in range(first, len(of)):
            of[k].update(zip(columns, values[k + 1]))
    return edit


DEGREE = math.pi / 180.0
# file, change, message
MISTAKES = [
    ("points", scale(y=-1), "the y axis of the image points has the other sense"),
    ("points", scale(x=-1), "the images are mirrored"),
    ("points", scale(x=-1, y=-1), "the camera is turned by 180 deg"),
    ("points", exchange("x", "y"), "x and y of the image points are exchanged"),
    ("points", scale(x=1e-3, y=1e-3), "check unit and pixel"),
    ("images", scale(roll=-1), "roll has the other sign"),
    ("images", scale(pitch=-1), "pitch has the other sign"),
    ("images", scale(heading=-1), "heading has the other sign"),
    ("images", exchange("roll", "pitch"), "roll and pitch are exchanged"),
    ("images", scale(roll=DEGREE, pitch=DEGREE, heading=DEGREE), "the angles are in radians"),
    ("images", scale(roll=1 / 0.9, pitch=1 / 0.9, heading=1 / 0.9), "the angles are in gon"),
    ("images", lambda rows: [r.update(heading=float(r["heading"]) + 180.0) for r in rows] and rows, "headings are off by 180 deg"),
    ("images", scale(x=1 / 0.3048, y=1 / 0.3048, z=1 / 0.3048), "stations are in feet"),
    ("images", scale(z=1 / 0.3048), "heights of the stations are in feet"),
    ("images", next_station("2", 0), "the stations of strip 2 are those of the image after"),
    ("images", next_station("2", 2), "the stations of strip 2 from image s2_3 on are those of the image after"),
    ("images", lambda rows: rows[:3] + rows[4:], "image s1_4 has image points and is not in the table"),
    ("control", scale(x=1 / 0.3048, y=1 / 0.3048, z=1 / 0.3048), "control is in feet"),
    ("control", exchange("x", "y"), "easting and northing of control are exchanged"),
    ("control", lambda rows: rows[0].update(name="c1") or rows[1].update(name="c0"), "c1, c0 of 5"),
    ("control", lambda rows: [*rows, rows[0]], "control point c0 is there twice"),
    ("points", lambda rows: [*rows, rows[5]], "measured twice: point"),
]


class Mistakes(Case):
    def refused(self, message, code=1):
        self.assert_error(swath("block", self.folder / "block.toml", "--output", self.folder / "out"), code, message)
        self.assertFalse((self.folder / "out").exists())

    def test_a_right_block_is_adjusted(self):
        for angles in (0.01, None):
            write(self.folder, angles=angles)
            done = swath("block", self.folder / "block.toml", "--output", self.folder / "out")
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertNotIn("does not fit", done.stdout)
            self.assertNotIn("a third", done.stdout)

    def test_each_is_named(self):
        for file, edit, message in MISTAKES:
            with self.subTest(message):
                write(self.folder)
                change(self.folder / f"{file}.csv", edit)
                self.refused(message)

    def test_conventions_of_the_config(self):
        for old, new, message in (('origin = "middle"', 'origin = "corner"', "the image points count from the middle of the sensor, not from a corner"),
                                  ('unit = "mm"', 'unit = "um"', "the image points are in mm, not in um"),
                                  ('f = "50.0 mm"', 'f = "5.0 mm"', "the principal distance is ten times too small")):
            write(self.folder)
            config = self.folder / "block.toml"
            config.write_text(config.read_text().replace(old, new))
            self.refused(message)

    def test_an_antenna_with_other_signs(self):
        write(self.folder, antenna=(0.4, -0.3, -1.1))
        config = self.folder / "block.toml"
        config.write_text(config.read_text().replace('["0.4 m", "-0.3 m", "-1.1 m"]', '["0.4 m", "0.3 m", "-1.1 m"]'))
        done = swath("block", config, "--output", self.folder / "out")
        self.assertRegex(done.stdout, "stations of camera C are on average .* of the stated antenna; the opposite sign of right explains it\n")

    def test_held_values_of_a_camera(self):
        camera = Camera(50.0, x0=0.021, y0=-0.034, k1=-2.1e-5, k2=1.2e-8, k3=-2e-12)
        write(self.folder, camera=camera)
        config = self.folder / "block.toml"
        text = config.read_text()
        config.write_text(text.replace("k1 = -2.1e-05", "k1 = 2.1e-05"))
        self.refused("the distortion has the other sign")
        for old, new, message in (("", "", None), ('distortion = "ideal"', 'distortion = "measured"', 'fit better with distortion = "ideal"'),
                                  ('x0 = "0.021 mm"', 'x0 = "-0.021 mm"', "fit better with the opposite sign of x0:"),
                                  ('y0 = "-0.034 mm"', 'y0 = "0.034 mm"', "fit better with the opposite sign of y0:")):
            config.write_text(text.replace(old, new))
            done = swath("block", config, "--output", self.folder / "out")
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertRegex(done.stdout, "image points of camera C " + message) if message else self.assertNotIn("fit better", done.stdout)

    def test_the_sign_of_a_boresight_with_its_sigma(self):
        write(self.folder, boresight=(0.005, -0.004, 0.006))
        config = self.folder / "block.toml"
        stated = 'boresight = ["0.2865 deg", "-0.2292 deg", "0.3438 deg"]\nsigma = { boresight = "0.02 deg" }\n'
        text = config.read_text().replace("[[image_points]]", stated + "[[image_points]]")
        config.write_text(text)
        self.assertNotIn("boresight", swath("block", config, "--output", self.folder / "out").stdout)
        config.write_text(text.replace('"0.2865 deg"', '"-0.2865 deg"'))
        done = swath("block", config, "--output", self.folder / "out")
        self.assertRegex(done.stdout, "boresight_roll of camera C is 0.2.* deg after the adjustment, .* the opposite sign explains it\n")

    def test_a_missing_event_without_angles(self):
        """The strip turns away from its neighbours before it is adjusted."""
        write(self.folder, angles=None, images=12)
        change(self.folder / "images.csv", next_station("2", 6))
        self.refused("the stations of strip 2 from image s2_[78] on are those of the image after")

    def test_heights_of_control_in_feet_without_angles(self):
        write(self.folder, angles=None)
        change(self.folder / "control.csv", scale(z=1 / 0.3048))
        self.refused("heights of control are in feet")

    def test_what_is_not_determined(self):
        write(self.folder, angles=None, control=False, sets="strip")
        self.refused("heights and plan of the points undetermined .strips 1, 2, 3")
        write(self.folder, angles=None, free=("boresight",))
        self.refused("C.boresight")
        write(self.folder, angles=None, control=False)
        config = self.folder / "block.toml"
        config.write_text(config.read_text().replace('stations = "observed"', 'stations = "start"'))
        self.refused("position, scale or attitude of the whole block")

    def test_images_without_points(self):
        for angles in (None, 0.01):
            write(self.folder, angles=angles)
            change(self.folder / "images.csv", lambda rows: [*rows, {**rows[3], "name": "extra"}])
            if angles:  # its orientation is the observed one
                done = swath("block", self.folder / "block.toml", "--output", self.folder / "out")
                self.assertIn("images without image points have their observed orientation: extra", done.stdout)
            else:
                self.refused("images without image points: extra")

    def test_wrong_points_are_named(self):
        write(self.folder)
        change(self.folder / "control.csv", lambda rows: rows[4].update(x=float(rows[4]["x"]) + 20.0))
        done = swath("block", self.folder / "block.toml", "--output", self.folder / "out")
        self.assertRegex(done.stdout, "control does not fit image points, which have no weight: c4;")


if __name__ == "__main__":
    unittest.main()
