# SPDX-License-Identifier: GPL-3.0-or-later
"""Blocks of images on the command line: accuracy before the flight, drifts of stations."""
import csv
import json
import struct
import unittest
import zlib

from support import SOURCE, Case, simulate, swath

# Ackermann's Quadro 1, recomputed; 0.5 % of each.
QUADRO_1 = [(0.959, 1.502), (1.620, 1.680), (2.101, 2.288), (1.533, 2.268)]


F, HEIGHT = 100.0, 1500.0  # mm, m: scale 1:15 000


def write_block(folder, y="up", drift="none", control_unit=1.0, relief=40.0, rows=350.0, first=700.0, between=700.0):
    """Three strips of five level images, flown to and fro, over points whose heights differ; exact image points."""
    points = {f"p{i}{j}": (300.0 * i, rows * j, relief * ((3 * i + 5 * j) % 7)) for i in range(9) for j in range(9)}
    images, marks = ["name,strip,time,x,y,z"], ["image,point,x,y"]
    for strip in range(3):
        way = 1 if strip % 2 == 0 else -1
        for k in range(5):
            x, y0, z = 1200.0 + way * 600.0 * (k - 2), first + between * strip, HEIGHT + 5.0 * k
            name = f"s{strip}_{k}.jpg"
            images.append(f"{name},{strip},{1000 * strip + 10 * k},{x},{y0},{z}")
            for point, (px, py, pz) in points.items():
                u, v = (way * d * F / (z - pz) for d in (px - x, py - y0))
                if abs(u) < 60 and abs(v) < 60:
                    marks.append(f"{name},{point},{u:.9f},{v:.9f}")
    control = ["name,x,y,z"] + [",".join(map(str, [p, *(c / control_unit for c in points[p])])) for p in ("p00", "p80", "p08", "p88", "p44")]
    for name, lines in (("images", images), ("points", marks), ("control", control)):
        (folder / f"{name}.csv").write_text("\n".join(lines) + "\n")
    (folder / "block.toml").write_text(
        f'kind = "block_adjust"\ncrs = "local"\ndrift = "{drift}"\n[images]\nfile = "images.csv"\n[[camera]]\nname = "C"\nf = "{F} mm"\n'
        f'[[image_points]]\nfile = "points.csv"\nunit = "mm"\ny = "{y}"\norigin = "middle"\nsigma = "5 um"\n[[control]]\nfile = "control.csv"\n')
    return points


class Block(Case):
    def test_adjusts_files(self):
        points = write_block(self.folder)
        done = swath("block", self.folder / "block.toml", "--output", self.folder / "out", "--set", "adjust.components=false")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("15 images, 81 points", done.stdout)
        rows = (self.folder / "out" / "orientation.csv").read_text().splitlines()
        given = (self.folder / "images.csv").read_text().splitlines()[1:]
        for row, image in zip([r for r in rows if not r.startswith("#")][1:], given):
            cells, stated = row.split(","), image.split(",")
            for got, want in zip(cells[3:6], stated[3:6]):
                self.assertAlmostEqual(float(got), float(want), delta=2e-4)
            self.assertAlmostEqual(float(cells[6]), 0.0, delta=1e-5)  # omega
        found = json.loads((self.folder / "out" / "block.json").read_text())
        self.assertEqual((found["images"], found["control"], found["rejected"]), (15, 5, 0))
        self.assertIn("<svg", (self.folder / "out" / "report.html").read_text())
        self.assertEqual(len(points), found["points"])

    def test_what_it_writes_for_other_programs_it_reads(self):
        """Image points as PAT-B, COLMAP and OpenSfM have them give the same orientations."""
        write_block(self.folder)
        config = self.folder / "block.toml"
        sensor = f'f = "{F} mm"\ncolumns = 13000\nrows = 13000\npixel = "10 um"\n'
        config.write_text(config.read_text().replace(f'f = "{F} mm"\n', sensor))
        self.assertEqual(swath("block", config, "--output", self.folder / "out", "--set", "adjust.components=false").returncode, 0)
        head = f'crs = "local"\n[images]\nfile = "images.csv"\n[[camera]]\nname = "C"\n{sensor}[[image_points]]\n'
        for name, points in (("patb", 'file = "out/patb/block.im"\nformat = "patb"\nunit = "um"\ny = "up"\norigin = "middle"\nsigma = "5 um"\n'),
                             ("colmap", 'file = "out/colmap"\nformat = "colmap"\nsigma = "5 um"\n'),
                             ("opensfm", 'file = "out/opensfm/tracks.csv"\nformat = "opensfm"\nsigma = "5 um"\n')):
            control = '[[control]]\nfile = "control.csv"\n' if name == "patb" else ""  # the others have numbers for names
            (self.folder / "again.toml").write_text(head + points + control)
            done = swath("block", self.folder / "again.toml", "--output", self.folder / name, "--set", "adjust.components=false")
            self.assertEqual(done.returncode, 0, done.stderr)
            rows = [[r for r in (self.folder / f / "orientation.csv").read_text().splitlines() if not r.startswith("#")][1:] for f in ("out", name)]
            self.assertEqual(len(rows[0]), 15)
            for a, b in zip(*rows):
                for k in (3, 4, 5, *range(12, 21)):  # place to the table's digits, and the matrix
                    self.assertAlmostEqual(float(a.split(",")[k]), float(b.split(",")[k]), delta=2e-4 if k < 6 else 1e-8, msg=(name, k))
        orientation = (self.folder / "out" / "patb" / "block.ori").read_text().splitlines()
        self.assertEqual(len(orientation), 45)
        first = rows[0][0].split(",")
        for k in range(3):
            self.assertAlmostEqual(float(orientation[0][32 + 16 * k:48 + 16 * k]), float(first[3 + k]), delta=1e-4)
        matrix = [float((orientation[1] + orientation[2])[16 * k:16 * k + 16]) for k in range(9)]
        for got, want in zip(matrix, map(float, first[12:21])):
            self.assertAlmostEqual(got, want, delta=2e-12)

    def test_what_is_read_is_not_written_over(self):
        write_block(self.folder)
        config = (self.folder / "block.toml").rename(self.folder / "camera.toml")
        text = config.read_text()
        self.assert_error(swath("block", config, "--output", self.folder), 2, "would overwrite", "camera.toml")
        self.assertEqual((config.read_text(), (self.folder / "orientation.csv").exists()), (text, False))

    def test_mistakes_are_named(self):
        write_block(self.folder, y="down")
        self.assert_error(swath("block", self.folder / "block.toml", "--output", self.folder / "out"), 1, "y axis of the image points has the other sense")
        write_block(self.folder, control_unit=0.3048)
        self.assert_error(swath("block", self.folder / "block.toml", "--output", self.folder / "out"), 1, "control is in feet")
        self.assertFalse((self.folder / "out").exists())
        # Level ground and 22 % of overlap between strips, as in the theory: relief or more overlap would determine the heights.
        write_block(self.folder, drift="strip", relief=0.0, rows=400.0, first=400.0, between=1400.0)
        corners = (self.folder / "control.csv").read_text().splitlines()[:-1]
        (self.folder / "control.csv").write_text("\n".join(corners) + "\n")
        self.assert_error(swath("block", self.folder / "block.toml", "--output", self.folder / "out"), 1, "(?s)heights.*cross strips.*chains of height control")
        self.assert_error(swath("block", self.folder / "block.toml", "--set", "crs="), 2, "crs is not stated")

    def test_geolocation_of_other_programs(self):
        """The angles of geo.txt and geolocation.csv are those of a body under whose front the image's upper edge lies."""
        flown = simulate(self.folder / "flown", ["output.laser=false", "imu.file=false", "gnss.file=false", "events.file=true", "camera.file=true",
                                                 "events.interval=3 s", "world.length=500 m", "world.width=300 m", "flight.lines=2",
                                                 "flight.cross_lines=0", "flight.height=400 m", "camera.points=30", "noise.noise_free=true",
                                                 'camera.boresight=["0 deg", "0 deg", "0 deg"]'])
        done = swath("block", flown / "block.toml", "--output", self.folder / "out", "--set", "adjust.components=false", "--set",
                     'crs="EPSG:32632+ellipsoidal"')
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(flown / "truth" / "images.csv") as f:
            truth = {r["name"]: [float(r[k]) for k in ("x", "y", "z", "heading", "pitch", "roll")] for r in csv.DictReader(f)}
        for file, separator in (("geo.txt", " "), ("geolocation.csv", ",")):
            first, *lines = (self.folder / "out" / file).read_text().splitlines()
            self.assertIn("EPSG:32632", first)
            self.assertEqual(len(lines), len(truth))
            for line in lines:
                name, *values = line.split(separator)
                self.assertEqual(len(values), 8)
                for k, (got, want) in enumerate(zip(map(float, values), truth[name])):
                    off = (got - want + 180.0) % 360.0 - 180.0 if k == 3 else got - want
                    self.assertLess(abs(off), 0.1 if k < 3 else 0.01, (file, name, k))

    def test_check_knows_configs_of_blocks(self):
        theory = SOURCE / "configs" / "flight" / "block_theory.toml"
        self.assertIn("a block of 6 strips of 21 images", swath("check", theory).stdout)
        self.assert_error(swath("check", theory, "--set", "strips=0"), 2, "strips")
        write_block(self.folder)
        self.assertIn("1 file of image points", swath("check", self.folder / "block.toml").stdout)

    def test_quadro_1(self):
        done = swath("block-theory", "--json")
        self.assertEqual(done.returncode, 0, done.stderr)
        cases = json.loads(done.stdout)["cases"]
        self.assertEqual(len(cases), 4)
        for case, (xy, z) in zip(cases, QUADRO_1):
            self.assertAlmostEqual(case["mu_xy"], xy, delta=0.005 * xy, msg=case["case"])
            self.assertAlmostEqual(case["mu_z"], z, delta=0.005 * z, msg=case["case"])

    def test_a_config_and_its_options(self):
        config = SOURCE / "configs" / "flight" / "block_theory.toml"
        fine = json.loads(swath("block-theory", config, "--json").stdout)["cases"]
        poor = json.loads(swath("block-theory", config, "--set", 'sigma_station="3 m"', "--json").stdout)["cases"]
        self.assertEqual([c["case"] for c in fine], ["no drift, chains", "strip drift, two cross strips"])
        for a, b in zip(fine, poor):
            self.assertTrue(1.65 < b["mu_xy"] / a["mu_xy"] < 2.35)
        self.assert_error(swath("block-theory", config, "--set", "strips=0"), 2, "strips")
        self.assert_error(swath("block-theory", config, "--set", 'sigma_station="3"'), 2, "sigma_station")

    def test_what_is_not_determined_is_named(self):
        config = self.folder / "corners.toml"
        config.write_text('[[case]]\nname = "corners"\ndrift = "strip"\ncontrol = "corners"\n')
        done = swath("block-theory", config)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertRegex(done.stdout, "corners: refused: .*heights.*cross strips.*chains of height control")

    def test_drifts(self):
        table = self.folder / "differences.csv"
        table.write_text("strip,time,dx,dy\n1,0,1.0,0\n1,10,2.0,0\n1,20,3.0,0\n2,100,5,1\n2,110,5,-1\n")
        found = json.loads(swath("block-drift", table, "--json").stdout)
        self.assertEqual([f["coordinate"] for f in found], ["dx", "dy"])
        self.assertAlmostEqual(found[0]["strips"][0]["drift_per_s"], 0.1)
        self.assertAlmostEqual(found[0]["strips"][0]["rms_less_line"], 0.0)
        self.assertIn("strip 2", swath("block-drift", table, "--column", "dy").stdout)
        self.assert_error(swath("block-drift", table, "--column", "dz"), 1, "dz")
        table.write_text("strip,time,dx\n1,0,x\n")
        self.assert_error(swath("block-drift", table), 1, "differences.csv:2")
        table.write_text("strip,time\n1,0\n")
        self.assert_error(swath("block-drift", table), 1, "no column of differences")


class Undistort(Case):
    def test_images(self):
        columns, rows = 60, 40
        values = b"".join(b"\0" + bytes(v for c in range(columns) for v in (4 * c, 6 * r, 100)) for r in range(rows))
        chunk = lambda kind, data: struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))  # noqa: E731
        image, camera = self.folder / "a.png", self.folder / "camera.toml"
        image.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", columns, rows, 8, 2, 0, 0, 0)) +
                          chunk(b"IDAT", zlib.compress(values)) + chunk(b"IEND", b""))
        text = f'[[camera]]\nname = "C"\nf = "20 mm"\nx0 = "0.5 mm"\nk1 = -1e-4\ndistortion = "ideal"\ncolumns = {columns}\nrows = {rows}\npixel = "300 um"\n'
        camera.write_text(text)
        first, second = self.folder / "first", self.folder / "second"
        done = swath("undistort", image, "--camera", camera, "--output", first)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(sorted(p.name for p in first.iterdir()), ["a.tif", "camera.toml"])
        # By the camera that was written they change no more.
        done = swath("undistort", first / "a.tif", "--camera", first / "camera.toml", "--output", second)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual((first / "a.tif").read_bytes(), (second / "a.tif").read_bytes())
        self.assert_error(swath("undistort", first / "a.tif", "--camera", first / "camera.toml", "--output", first), 2, "written over")
        # The camera that is read is not written over.
        self.assert_error(swath("undistort", image, "--camera", camera, "--output", self.folder), 2, "would overwrite", "camera.toml")
        self.assertEqual((camera.read_text(), (self.folder / "a.tif").exists()), (text, False))
        self.assert_error(swath("undistort", image, "--camera", camera, "--name", "D"), 2, "no camera is named D")
        camera.write_text(text.replace("rows = 40", "rows = 41"))
        self.assert_error(swath("undistort", image, "--camera", camera, "--output", self.folder / "third"), 1, "60 x 40 pixels, camera C has 60 x 41")
        self.assertFalse((self.folder / "third").exists())


if __name__ == "__main__":
    unittest.main()
