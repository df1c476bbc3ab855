# SPDX-License-Identifier: GPL-3.0-or-later
"""The joint adjustment as its user meets it: configs/network.toml on a small MEMS survey."""
import json
import unittest

from support import SOURCE, Case, stage, swath

CONFIG = SOURCE / "configs" / "network.toml"
# Two lines and one across over halls, raw records alone.
SURVEY = ["world.scene=airfield", "world.length=300 m", "world.width=200 m", "flight.lines=2", "flight.cross_lines=1", "flight.overlap=0.6",
          "flight.height=300 m", "scanner.prf=8 kHz", "scanner.frequency=25 Hz", "mounting.deliver=truth", "imu.grade=mems", "gnss.rate=1 Hz",
          "output.trajectory=none", "output.truth_returns=false"]


class Network(Case):
    simulated = SURVEY

    def test_surfaces_correct_the_trajectory_and_the_report_says_how_well(self):
        report = self.run_ok(self.survey / "survey.toml", config=CONFIG)
        found = stage(report, "calib.network")["findings"]
        self.assertTrue(found["settled"])
        self.assertLess(found["rms_after_m"], 0.2 * found["rms_before_m"])  # 0.03 to 0.14 over twelve seeds
        smoother, network = (found["truth"][who]["lines"] for who in ("smoother", "network"))
        # Roll is what overlapping lines see. Pitch and heading of a single survey this small may come out larger than the smoother's; what must
        # hold of them is their sigma (error / sigma up to 1.8 over twelve seeds).
        self.assertLess(network["roll"]["rms_arcsec"], 0.95 * smoother["roll"]["rms_arcsec"])
        for angle in ("roll", "pitch", "heading"):
            self.assertLess(network[angle]["error_over_sigma"], 3.0, angle)
        self.assertEqual(set(found["values"]), {"boresight_roll", "boresight_pitch", "boresight_heading"})
        self.assertEqual(json.loads((self.out / "network.json").read_text())["planes"], found["planes"])
        calibration = json.loads((self.out / "calibration.json").read_text())
        self.assertIn("calibration", calibration)
        kinds = found["components"]
        for kind in ("planes", "returns", "gnss_position"):
            self.assertLess(abs(kinds[kind]["factor"] - 1), 0.4, kind)
        self.assertLess(found["surface_sigma_m"], 0.003)  # roofs and ground of the simulation are planes to a millimetre
        named = found.get("left_out", [])
        self.assertEqual(len(named), min(20, found["groups_left_out"]))
        self.assertEqual(sorted(named, key=lambda g: -abs(g["off_m"])), named)
        for group in named:
            self.assertIn(group["line"], (1, 2, 3))
            self.assertGreater(abs(group["off_m"]), 3 * group["sigma_m"])
        page = (self.out / "report.html").read_text()
        for heading in ("Joint adjustment", "What the surfaces changed", "Biases of the IMU", "Differences between lines"):
            self.assertIn(heading, page)
        self.assertIn("plane_differences", json.loads((self.out / "adjustment.json").read_text()))
        self.assertGreater((self.out / "trajectory.sbet").stat().st_size, 136 * 1000)
        self.assertTrue((self.out / "trajectory.smrmsg").exists())

    def test_without_the_grade_of_the_imu_it_is_refused(self):
        text = (self.survey / "survey.toml").read_text()
        kept = text[:text.index("[imu_spec]")] + "\n".join(text[text.index("[imu_spec]"):].split("\n\n", 1)[1:])
        (self.survey / "unstated.toml").write_text(kept)
        done = swath("run", CONFIG, "--survey", self.survey / "unstated.toml", "--output", self.out, "--quiet")
        self.assert_error(done, 2, "how good the IMU is", "hint: ")


if __name__ == "__main__":
    unittest.main()
