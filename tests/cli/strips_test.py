# SPDX-License-Identifier: GPL-3.0-or-later
"""Strip adjustment as its user meets it: configs/strips.toml on a small survey whose lines are off."""
import json
import unittest

from support import SOURCE, Case, stage, swath

CONFIG = SOURCE / "configs" / "strips.toml"
# Two lines and one across over halls.
SURVEY = ["imu.file=false", "gnss.file=false", "world.scene=airfield", "world.length=300 m", "world.width=200 m", "flight.lines=2",
          "flight.cross_lines=1", "flight.overlap=0.6", "flight.height=300 m", "scanner.prf=8 kHz", "scanner.frequency=25 Hz",
          "mounting.deliver=truth", "noise.line_shift=8 cm", "noise.line_drift=6 cm", "noise.line_attitude=0.01 deg", "control.targets=3",
          "control.points=5", "output.truth_returns=false"]
# rms on planes after the adjustment, of means of a hundred returns with 1.5 cm noise and a footprint's worth of pointing.
MEET = 0.02


class Strips(Case):
    simulated = SURVEY

    def test_the_lines_meet_and_the_trajectory_is_corrected(self):
        report = self.run_ok(self.survey / "survey.toml", config=CONFIG)
        told = stage(report, "calib.strips")["findings"]["plane_differences"]
        self.assertGreater(told["rms_before"], 0.03)
        self.assertLess(told["rms_after"], min(MEET, told["rms_before"] / 2))
        tree = json.loads((self.out / "strips.json").read_text())
        self.assertAlmostEqual(tree["plane_differences"]["all"]["rms_after"], told["rms_after"])
        self.assertGreaterEqual(len(tree["plane_differences"]["pairs"]), 3)
        self.assertIn("Lines meet within", tree["verdict"])
        self.assertIn(tree["verdict"], (self.out / "report.html").read_text())
        self.assertNotIn("calibration", tree)
        self.assertTrue(list((self.out / "differences").glob("*_after.tif")))
        self.assertTrue(list((self.out / "figures").glob("difference_*_after.png")))
        self.assertNotEqual((self.out / "trajectory.sbet").read_bytes(), (self.survey / "sbet.out").read_bytes())
        corrected = self.out
        self.out = self.folder / "plain"
        self.run_ok(self.survey / "survey.toml", config=self.without_strips())
        points = lambda folder: b"".join(p.read_bytes() for p in sorted((folder / "points").iterdir()))
        self.assertNotEqual(points(corrected), points(self.out), "the cloud is that of the corrected trajectory")

    def without_strips(self):
        config = self.folder / "plain.toml"
        config.write_text(CONFIG.read_text().replace('[[stage]]\ntype = "calib.strips"\n', ""))
        return config


class OneLine(Case):
    simulated = [o for o in SURVEY if not o.startswith(("flight.lines", "flight.cross_lines"))] + ["flight.lines=1", "flight.cross_lines=0"]

    def test_one_line_is_refused(self):
        done = swath("run", CONFIG, "--survey", self.survey / "survey.toml", "--output", self.out, "--quiet")
        self.assert_error(done, 1, "one flight line", "hint: ")


if __name__ == "__main__":
    unittest.main()
