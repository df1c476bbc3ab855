# SPDX-License-Identifier: GPL-3.0-or-later
"""run.memory holds as the peak of the whole process, whatever a tile asks for; tiles that are cut give the same products."""
import json
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
# All of these can be cut.
RASTERS = ["readers.trajectory", "readers.laser", "georeference", "filters.returns", "filters.noise", "quality.lines", "filters.smrf",
           "terrain.dtm", "terrain.dsm", "terrain.density", "terrain.intensity"]
TOLERANCE = 1.1


class Memory(Case):
    simulated = DENSE

    def run_within(self, megabytes, name, *more, stages=tuple(STAGES)):
        """Exit code, peak in bytes, output folder and messages."""
        config = self.folder / "memory.toml"
        config.write_text("".join(f'[[stage]]\ntype = "{s}"\n' for s in stages))
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

    def test_files_of_tiles_that_are_cut_are_the_same(self):
        fine = ["--set", "dtm.cell=25 cm", "--set", "dsm.cell=25 cm", "--set", "density.cell=25 cm"]
        code, _, cut, said = self.run_within(200, "cut", *fine, stages=RASTERS)
        self.assertEqual(code, 0, said)
        stages = json.loads((cut / "report.json").read_text())["stages"]
        self.assertIn("terrain.dtm", [s["type"] for s in stages if s.get("tiles_cut_to_fit_memory", 0) > 0])
        code, _, whole, said = self.run_within(2000, "whole", *fine, stages=RASTERS)
        self.assertEqual(code, 0, said)
        stages = json.loads((whole / "report.json").read_text())["stages"]
        self.assertEqual([s["type"] for s in stages if "tiles_cut_to_fit_memory" in s], [])
        self.assertEqual(products(cut), products(whole))

    def test_a_refusal_keeps_what_an_earlier_run_has_done(self):
        keep = ["--set", "run.keep_work=true"]
        code, _, out, said = self.run_within(1000, "kept", *keep)
        self.assertEqual(code, 0, said)
        code, _, _, said = self.run_within(200, "kept", "--set", "dtm.cell=5 cm", *keep)
        self.assertEqual(code, 2, said)
        self.assertIn("run.memory = 200 MB", said)
        code, _, _, said = self.run_within(1000, "kept", *keep)
        self.assertEqual(code, 0, said)
        self.assertGreaterEqual(json.loads((out / "report.json").read_text())["pieces_resumed"], 3)


if __name__ == "__main__":
    if not sys.platform.startswith("linux"):
        sys.exit(77)
    unittest.main()
