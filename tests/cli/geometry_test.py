# SPDX-License-Identifier: GPL-3.0-or-later
"""What a run says of its own geometry where lines share little ground."""
import unittest

from support import Case, simulate

# A scanner 40 m above the ground: its lines share a dozen cells, too few to judge by.
LOW = ["world.scene=flat", "world.length=60 m", "world.width=50 m", "flight.lines=2", "flight.cross_lines=1", "flight.height=40 m",
       "flight.speed=8 m/s", "flight.lead=4 s", "scanner.prf=3 kHz", "scanner.frequency=20 Hz", "scanner.half_angle=35 deg"]
STAGES = ("readers.trajectory", "readers.laser", "quality.geometry", "georeference", "writers.las")


class FewSharedCells(Case):
    def test_a_right_flight_is_not_blamed(self):
        config = self.folder / "geometry.toml"
        config.write_text("".join(f'[[stage]]\ntype = "{s}"\n' for s in STAGES))
        for seed in (8, 9):
            with self.subTest(seed=seed):
                survey = simulate(self.folder / f"survey_{seed}", LOW + [f"seed={seed}"])
                report = self.run_ok(survey / "survey.toml", config=config, out=self.folder / f"out_{seed}")
                self.assertEqual(report["geometry"]["verdict"], "not judged")
                self.assertLess(report["geometry"]["fit"]["cells"], 30)
                self.assertEqual(report["warnings"], [])


if __name__ == "__main__":
    unittest.main()
