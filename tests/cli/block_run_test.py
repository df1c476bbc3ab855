# SPDX-License-Identifier: GPL-3.0-or-later
"""A block of images as stages of a run: from a flight's records to oriented images, and mistakes of its survey."""
import csv
import json
import math
import re
import shutil
import tomllib
import unittest

from support import SOURCE, Case, simulate, stage, substitute, swath

CONFIG = SOURCE / "configs" / "block.toml"
CAMERA = ["output.laser=false", "events.file=true", "events.interval=3 s", "camera.file=true", "world.scene=hills", "world.length=500 m",
          "world.width=300 m", "flight.lines=2", "flight.cross_lines=1", "flight.height=400 m", "camera.points=40"]
# With a trajectory of its own a run takes a second.
STAGES = ("readers.trajectory", "time.sync", "orientation.direct", "block.adjust")


def rows_of(file):
    with open(file) as f:
        return list(csv.DictReader(line for line in f if not line.startswith("#")))


def rewrite(file, edit):
    """`edit` takes the rows as dictionaries and returns them, or others."""
    rows = rows_of(file)
    columns = list(rows[0])
    rows = edit(rows)
    file.write_text("\n".join([",".join(columns), *(",".join(str(r[c]) for c in columns) for r in rows)]) + "\n")


class BlockFlight(Case):
    """configs/block.toml on raw records."""
    simulated = [*CAMERA, "output.trajectory=none"]

    def test_from_raw_records_to_the_block(self):
        report = self.run_ok(self.survey / "survey.toml", config=CONFIG)
        found = stage(report, "block.adjust")["findings"]
        truth = {r["name"]: r for r in rows_of(self.survey / "truth" / "images.csv")}
        integrated = rows_of(self.out / "block" / "orientation.csv")
        self.assertEqual([r["image"] for r in integrated], sorted(truth, key=lambda n: float(truth[n]["time"])))
        for row in integrated:
            for k, axis in enumerate("xyz"):
                self.assertLess(abs(float(row[axis]) - float(truth[row["image"]][axis])), 5 * math.sqrt(float(row[f"c{k + 1}{k + 1}"])), row["image"])
        self.assertEqual([d["component"] for d in found["direct"]], ["east", "north", "up", "tilt about x", "tilt about y", "turn"])
        for d in found["direct"]:
            self.assertLess(d["integrated_sigma"], d["direct_sigma"], d)
            self.assertLess(d["rms_over_sigma"], 3.0, d)  # few images, and what they have in common
        self.assertEqual(found["started_from"], "direct orientation")
        for check in found["check"]:
            self.assertLess(check["over_sigma"], 2.0, check)
        self.assertEqual(json.loads((self.out / "block" / "block.json").read_text()), found)
        self.assertIn("Direct and integrated orientation", (self.out / "block" / "report.html").read_text())
        # The cameras after the adjustment are tables of a survey, and of `swath undistort`.
        camera = tomllib.loads((self.out / "block" / "camera.toml").read_text())["camera"][0]
        self.assertEqual(camera["technique"], "marks")
        for part, true in zip(camera["lever_arm"], (0.21, -0.08, 0.34)):
            self.assertLess(abs(float(part.split()[0]) - true), 0.05)
        for angle, true in zip(camera["boresight"], (0.31, -0.22, 0.53)):
            self.assertLess(abs(float(angle.split()[0]) - true), 0.02)
        text = (self.survey / "survey.toml").read_text()
        begin = text.index("[[camera]]")
        end = text.index("\n[[", begin)
        adjusted = self.survey / "adjusted.toml"
        adjusted.write_text(text[:begin] + (self.out / "block" / "camera.toml").read_text() + text[end:])
        self.assertEqual(swath("check", CONFIG, "--survey", adjusted).returncode, 0, swath("check", CONFIG, "--survey", adjusted).stderr)
        none = swath("undistort", self.folder / "none.jpg", "--camera", self.out / "block" / "camera.toml", "--output", self.folder / "u")
        self.assertIn("none.jpg", none.stderr)


class BlockRuns(Case):
    simulated = [*CAMERA, "imu.file=false", "gnss.file=false"]

    def setUp(self):
        super().setUp()
        self.config = self.folder / "run.toml"
        self.config.write_text("".join(f'[[stage]]\ntype = "{s}"\n' for s in STAGES))
        self.flown = self.copy()

    def run_block(self, *more, code=0, out=None):
        return self.run_ok(self.flown / "survey.toml", *more, config=self.config, code=code, out=out)

    def refused(self, code, *words):
        shutil.rmtree(self.out, ignore_errors=True)
        done = swath("run", self.config, "--survey", self.flown / "survey.toml", "--output", self.out, "--quiet")
        self.assert_error(done, code, *words)
        self.assertFalse((self.out / "block").exists())

    def test_what_changes_the_block_is_done_again_and_nothing_else(self):
        keep = ["--set", "run.keep_work=true"]
        first = self.run_block(*keep)
        same = self.run_block(*keep)
        self.assertGreater(same["pieces_resumed"], 0)
        other = self.run_block(*keep, "--set", "block.adjust.robust=false")
        self.assertEqual(other["pieces_resumed"], same["pieces_resumed"] - 1)
        prints = lambda r: {s["type"]: s["fingerprint"] for s in r["stages"]}  # noqa: E731
        self.assertEqual(prints(first), prints(same))
        changed = [k for k in STAGES if prints(first)[k] != prints(other)[k]]
        self.assertEqual(changed, ["block.adjust"])
        for file in ("image_points.csv", "block_control.csv"):
            rewrite(self.flown / file, lambda rows: rows[:-1])
            again = self.run_block(*keep)
            self.assertEqual(again["pieces_resumed"], 0, file)
            self.assertNotEqual(prints(again)["block.adjust"], prints(first)["block.adjust"])
            first = again

    def test_threads_change_nothing(self):
        outs = [self.folder / str(n) for n in (1, 2, 3)]
        for n, out in zip((1, 2, 3), outs):
            self.run_block("--set", f"run.threads={n}", out=out)
        for file in ("images.csv", "orientation_correlation.csv", "block/orientation.csv", "block/camera.toml", "block/block.json", "block/points.laz"):
            first = (outs[0] / file).read_bytes()
            for out in outs[1:]:
                self.assertEqual(first, (out / file).read_bytes(), f"{file} of {out.name} threads")

    def test_check_and_info_know_the_tables(self):
        self.assertEqual(swath("check", self.config, "--survey", self.flown / "survey.toml").returncode, 0)
        info = swath("info", self.flown / "survey.toml").stdout
        self.assertIn("image_points.csv", info)
        self.assertIn("block_control.csv", info)
        substitute(self.flown / "survey.toml", 'origin = "corner"\n', "")
        self.refused(2, r"image_points\[1\].origin", "one of middle, corner, pixel_centre")

    def test_the_order_of_stages(self):
        self.config.write_text("".join(f'[[stage]]\ntype = "{s}"\n' for s in STAGES if s != "orientation.direct"))
        self.refused(2, "needs orientations, which no stage before it gives.*orientation.direct")

    def test_images_by_a_list(self):
        names = {r["name"]: f"DSC_{1000 + int(r['name'])}.jpg" for r in rows_of(self.flown / "truth" / "images.csv")}
        rewrite(self.flown / "image_points.csv", lambda rows: [{**r, "image": names[r["image"]]} for r in rows])
        (self.flown / "list.csv").write_text("name,event\n" + "".join(f"{n},{e}\n" for e, n in names.items()))
        survey = self.flown / "survey.toml"
        survey.write_text(survey.read_text() + '\n[[image]]\nfile = "list.csv"\n')
        report = self.run_block()
        self.assertEqual(stage(report, "block.adjust")["findings"]["images"], len(names))
        self.assertTrue(rows_of(self.out / "block" / "orientation.csv")[0]["image"].startswith("DSC_"))
        first, second = list(names.items())[:2]
        for old, new, message in ((f"{second[1]},{second[0]}\n", f"{first[1]},{second[0]}\n", f"list.csv:3: .*image {first[1]} is there twice, first in"),
                                  (f"{second[1]},{second[0]}\n", f"{second[1]},{first[0]}\n", "are of one event, " + first[0]),
                                  (f"{second[1]},{second[0]}\n", f"{second[1]},9999\n", f"image {second[1]} is of event 9999, and no event"),
                                  (f"{second[1]},{second[0]}\n", "", f"image {second[1]} has image points and is none of the images")):
            text = (self.flown / "list.csv").read_text()
            substitute(self.flown / "list.csv", old, new)
            with self.subTest(message):
                self.refused(1, message)
            (self.flown / "list.csv").write_text(text)
        (self.flown / "list.csv").write_text("name,event,camera\n" + "".join(f"{n},{e},P9\n" for e, n in names.items()))
        self.refused(1, "camera P9 of image .* is not in the survey")

    def test_events_that_do_not_fit(self):
        marks = self.flown / "events_marks.csv"
        text = marks.read_text()
        rewrite(marks, lambda rows: rows[:3] + rows[4:])
        self.refused(1, "image 4 has image points and is none of the images that have an orientation", "its event is missing")
        # Every event has the id of the image before it, as where the first one is lost.
        marks.write_text(text)
        ids = [r["id"] for r in rows_of(marks)]
        rewrite(marks, lambda rows: [{**r, "id": i} for r, i in zip(rows, [ids[-1], *ids])])
        self.refused(1, "stations .*are those of the image (before|after)")
        marks.write_text(text)
        rewrite(marks, lambda rows: [rows[0], {**rows[1], "id": rows[0]["id"]}, *rows[2:]])
        self.refused(1, "there twice")

    def test_images_without_points_are_named(self):
        rewrite(self.flown / "image_points.csv", lambda rows: [r for r in rows if r["image"] != "2"])
        found = stage(self.run_block(), "block.adjust")["findings"]
        self.assertIn("images without image points have their observed orientation: 2", found["findings"])
        self.assertEqual(found["images_without_points"], ["2"])

    def test_control_elsewhere(self):
        control = self.flown / "block_control.csv"
        text = control.read_text()
        rewrite(control, lambda rows: [{**r, "x": float(r["x"]) + 5000.0} for r in rows])
        self.refused(1, "control points lie up to .* from where the images see them")
        control.write_text(text)
        rewrite(control, lambda rows: [{**r, **{k: float(r[k]) / 0.3048 for k in "xyz"}} for r in rows])  # the check points are in metres
        self.refused(1, "block_control.csv.* control is in feet: 5 of")
        control.write_text(text.replace("control", "other"))
        findings = stage(self.run_block(), "block.adjust")["findings"]
        self.assertIn("no point of block_control.csv is on an image: names differ, or it is the laser's control", findings["findings"])
        substitute(self.flown / "survey.toml", 'file = "block_control.csv"', 'file = "block_control.csv"\nkind = "z"')
        self.refused(1, "block_control.csv: no point of the file is on an image, and control of plan or heights alone serves images only")

    def test_control_without_names_is_not_that_of_numbered_tie_points(self):
        points = list(dict.fromkeys(r["point"] for r in rows_of(self.flown / "image_points.csv") if not r["point"].startswith(("control", "check"))))
        number = {p: str(k + 1) for k, p in enumerate(points)}
        rewrite(self.flown / "image_points.csv", lambda rows: [{**r, "point": number.get(r["point"], r["point"])} for r in rows])
        control = rows_of(self.flown / "block_control.csv")
        (self.flown / "laser.csv").write_text("x,y,z\n" + "".join(f"{float(r['x']) + 300},{r['y']},{r['z']}\n" for r in control))
        with open(self.flown / "survey.toml", "a") as survey:
            survey.write('\n[[control]]\nfile = "laser.csv"\n')
        found = stage(self.run_block(), "block.adjust")["findings"]
        self.assertEqual(found["control"], len(control))
        self.assertIn("no point of laser.csv is on an image: names differ, or it is the laser's control", found["findings"])

    def test_a_camera_that_is_not_described(self):
        substitute(self.flown / "survey.toml", 'technique = "marks"', 'technique = "mark"')  # of the events
        self.refused(2, "no event is of the technique marks of camera camera", "the events are of mark, pc")
        done = swath("check", self.config, "--survey", self.flown / "survey.toml")  # before hours of work
        self.assert_error(done, 2, "no event is of the technique marks of camera camera")

    def test_covariances_that_nothing_writes_are_missed_before_the_run(self):
        done = swath("check", self.config, "--survey", self.flown / "survey.toml", "--set", "orientation.direct.correlated_images=0")
        self.assert_error(done, 2, "orientation.direct writes no covariances", "correlated_images = 1 or more")

    def test_a_drift_per_strip_needs_strips(self):
        survey = self.flown / "survey.toml"
        survey.write_text(re.sub(r'\nstrip = "strip"|\n\[\[line\]\]\n(?:[^\[\n].*\n)*|\n\[line_time\]\n(?:[^\[\n].*\n)*', "\n", survey.read_text()))
        self.assertNotIn("[[line]]", survey.read_text())
        with open(self.config, "a") as config:
            config.write('drift = "strip"\n')
        self.refused(2, "drift is per strip, and no image has the number of a strip")

    def test_a_drift_per_strip_is_not_that_of_turns(self):
        with open(self.config, "a") as config:
            config.write('drift = "strip"\n')
        events = rows_of(self.flown / "events_marks.csv")
        listed = "".join(f"{e['id']},{e['id']},{0 if k in (2, 3) else e['strip']}\n" for k, e in enumerate(events))
        (self.flown / "list.csv").write_text("name,event,strip\n" + listed)
        survey = self.flown / "survey.toml"
        text = re.sub(r'\n\[\[line\]\]\n(?:[^\[\n].*\n)*|\n\[line_time\]\n(?:[^\[\n].*\n)*', "\n", survey.read_text())
        survey.write_text(text + '\n[[image]]\nfile = "list.csv"\nstrip = "strip"\n')
        names = f"{events[2]['id']}, {events[3]['id']}"
        self.refused(1, f"drift is per strip, and 2 images of {len(events)} have no strip, or strip 0: {names}", "leave those of turns out")

    def test_options_that_do_nothing_are_refused(self):
        done = swath("check", self.config, "--survey", self.flown / "survey.toml", "--set", "block.adjust.stations=start", "--set",
                     "block.adjust.drift=strip")
        self.assert_error(done, 2, "drift and datum have no effect")
        survey = self.flown / "survey.toml"
        survey.write_text(re.sub(r'(\[camera\.sigma\]\n[^\[]*?)lever_arm = "[^"]*"', r'\1lever_arm = "free"', survey.read_text(), count=1))
        done = swath("check", self.config, "--survey", survey, "--set", "block.adjust.stations=start")
        self.assert_error(done, 2, "the lever arm of camera camera is free, and stations are values to start from")


if __name__ == "__main__":
    unittest.main()
