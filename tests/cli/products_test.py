# SPDX-License-Identifier: GPL-3.0-or-later
"""One small survey through the stages that end a chain: power lines, trees, quality, COPC; what they say of each other and of the truth agrees."""
import csv
import json
import math
import unittest

from support import Case, stage, swath

# Two lines over every kind of object, some 200 000 returns.
SURVEY = ["imu.file=false", "gnss.file=false", "world.scene=zoo", "world.length=240 m", "world.width=160 m", "world.power_line=true", "flight.lines=2",
          "flight.cross_lines=0", "flight.height=400 m", "scanner.prf=20 kHz", "mounting.deliver=truth", "control.points=8"]
CHAIN = ["readers.trajectory", "readers.laser", "georeference", "filters.returns", "filters.noise", "filters.outlier", "quality.lines", "filters.ground",
         "terrain.dtm", "terrain.dsm", "filters.hag_dem", "filters.classify", "terrain.powerlines", "terrain.forest", "terrain.canopy", "quality.density",
         "quality.swath", "quality.surface", "quality.points", "report.quality", "writers.las", "writers.copc"]
OPTIONS = {"filters.noise": "neighbours = 2", "quality.surface": 'reference = "truth/dtm.tif"', "quality.swath": 'quality_level = "QL2"',
           "terrain.powerlines": 'ground = "6 m"\nvegetation = "3 m"\nbuilding = "5 m"\nwire = "1 m"'}


def rows(file):
    with open(file, newline="") as text:
        return list(csv.DictReader(text))


class Products(Case):
    simulated = SURVEY

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.made, config = cls.class_folder / "made", cls.class_folder / "all.toml"
        config.write_text("".join(f'[[stage]]\ntype = "{name}"\n{OPTIONS.get(name, "")}\n' for name in CHAIN))
        done = swath("run", config, "--survey", cls.survey / "survey.toml", "--output", cls.made, "--quiet")
        if done.returncode != 0:
            raise AssertionError(done.stderr)
        cls.report = json.loads((cls.made / "report.json").read_text())

    def found(self, name):
        return stage(self.report, name)["findings"]

    def test_no_return_is_lost_on_the_way(self):
        counts = [s["counts"] for s in self.report["stages"] if s["type"].startswith("filters.")]
        self.assertEqual(len(counts), 6)
        self.assertEqual({c["in"] for c in counts}, {c["out"] for c in counts})
        self.assertEqual(self.found("writers.copc")["points"], counts[-1]["out"])
        head = (self.made / "points.copc.laz").read_bytes()[:589]
        self.assertEqual((head[:4], head[377:381]), (b"LASF", b"copc"))  # the first record after the header is COPC's

    def test_power_line(self):
        wires = rows(self.survey / "truth/wires.csv")
        found, conductors = self.found("terrain.powerlines"), rows(self.made / "powerlines_conductors.csv")
        self.assertEqual(found["conductors"], len(conductors))
        self.assertGreaterEqual(len(conductors), len(wires))
        self.assertEqual(len(rows(self.made / "powerlines_spans.csv")), found["spans"])
        self.assertEqual(len(rows(self.made / "powerlines_pylons.csv")), found["pylons"])
        near = rows(self.made / "powerlines_infringements.csv")  # of each conductor; a square metre that two come near counts once
        self.assertEqual(len({(r["of"], math.floor(float(r["x"])), math.floor(float(r["y"]))) for r in near}), found["infringements"])
        self.assertEqual(len(rows(self.made / "powerlines_falling_trees.csv")), found["falling_trees"])
        lowest = {"low": float(wires[0]["z0"]), "found": min(float(c["z0"]) for c in conductors)}
        self.assertLess(abs(lowest["found"] - lowest["low"]), 1.0, lowest)
        for clearance in found["clearances"]:
            self.assertLessEqual(clearance["swung_m"], clearance["at_rest_m"])

    def test_trees(self):
        found, trees = self.found("terrain.forest"), rows(self.made / "trees.csv")
        self.assertEqual(found["trees"], len(trees))
        true = len(rows(self.survey / "truth/trees.csv"))
        self.assertGreater(len(trees), 0.3 * true)
        self.assertLess(len(trees), 1.2 * true)

    def test_terrain_agrees_with_its_reference_and_check_points(self):
        surface = self.found("quality.surface")
        self.assertLess(surface["rms_m"], 0.3)
        whole = next(c for c in surface["classes"] if (c["slope"], c["cover"]) == ("all", "all"))
        self.assertEqual(whole["rms_m"], surface["rms_m"])
        self.assertEqual(self.found("quality.points")["marks"], 8)
        self.assertLess(self.found("quality.points")["nva_m"], 0.2)

    def test_quality_level_is_judged_and_reported(self):
        judged = self.found("report.quality")
        measured = [r for r in judged["requirements"] if r["value"] is not None]
        self.assertEqual(measured, judged["requirements"])
        self.assertEqual(judged["judged"], len(measured))
        self.assertGreaterEqual(judged["missed"], 1)  # 1.5 pulses per m2, 2 are required
        self.assertEqual(judged["missed"], sum(not r["met"] for r in measured))
        for name in ("quality.html", "quality.pdf", "quality.xml", "swath.gpkg", "overlap_dz.vrt", "surface_profiles.csv"):
            self.assertGreater((self.made / name).stat().st_size, 100, name)


if __name__ == "__main__":
    unittest.main()
