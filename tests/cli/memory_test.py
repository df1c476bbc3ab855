# SPDX-License-Identifier: GPL-3.0-or-later
"""run.memory holds as the peak of the whole process, whatever a tile asks for; tiles that are cut give the same products."""
import os
import subprocess
import sys
import unittest

from support import SWATH, Case, products

# Two lines of some 300 000 returns on one tile: more than 200 MB where it is worked on whole.
DENSE = ["imu.file=false", "gnss.file=false", "world.scene=hills", "world.length=300 m", "world.width=200 m", "flight.lines=2",
         "flight.cross_lines=0", "flight.height=300 m", "scanner.prf=60 kHz", "scanner.frequency=60 Hz", "mounting.deliver=truth"]
STAGES = ["readers.trajectory", "readers.laser", "georeference", "filters.returns", "filters.noise", "quality.lines", "filters.smrf",
          "terrain.dtm", "terrain.dsm", "terrain.density", "filters.hag_dem", "terrain.contours", "writers.las", "writers.gdal",
          "writers.picture"]
TOLERANCE = 1.1


class Memory(Case):
    simulated = DENSE

    def run_within(self, megabytes, name, *more):
        """Exit code, peak in bytes, output folder and messages."""
        config = self.folder / "memory.toml"
        config.write_text("".join(f'[[stage]]\ntype = "{s}"\n' for s in STAGES))
        out = self.folder / name
        with open(self.folder / "log", "w+") as log:
            process = subprocess.Popen([SWATH, "run", config, "--survey", self.survey / "survey.toml", "--output", out, "--quiet", "--set",
                                        f"run.memory={megabytes} MB", "--threads", "2", *more], stderr=log)
            _, status, used = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
            log.seek(0)
            return process.returncode, used.ru_maxrss * 1024, out, log.read()

    def test_a_small_budget_holds_and_the_products_are_the_same(self):
        code, peak, small, said = self.run_within(200, "small")
        self.assertEqual(code, 0, said)
        self.assertLessEqual(peak, TOLERANCE * 200e6)
        code, peak, large, said = self.run_within(1000, "large")
        self.assertEqual(code, 0, said)
        self.assertGreater(peak, TOLERANCE * 200e6, "the survey is too small for this test")
        self.assertEqual(products(small), products(large))

    def test_what_does_not_fit_is_refused_before_any_point_is_read(self):
        code, peak, out, said = self.run_within(200, "refused", "--set", "run.tile=2 km", "--set", "dtm.cell=20 cm")
        self.assertEqual(code, 2, said)
        self.assertIn("run.memory = 200 MB", said)
        self.assertLessEqual(peak, TOLERANCE * 200e6)
        self.assertFalse((out / "points").exists())


if __name__ == "__main__":
    if not sys.platform.startswith("linux"):
        sys.exit(77)
    unittest.main()
