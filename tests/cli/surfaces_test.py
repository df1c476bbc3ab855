# SPDX-License-Identifier: GPL-3.0-or-later
"""Contours, volumes and profiles of a run's products, as their user calls them."""
import json
import re
import unittest

from support import CONFIG, SMALL, Case, stage, swath


class Surfaces(Case):
    simulated = SMALL

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.made = cls.survey.parent / "made"
        done = swath("run", CONFIG, "--survey", cls.survey / "survey.toml", "--output", cls.made, "--quiet", "--set", "contours.min_area=\"5 m2\"")
        if done.returncode != 0:
            raise AssertionError(done.stderr)

    def test_the_report_tells_which_interval_the_model_carries(self):
        told = stage(json.loads((self.made / "report.json").read_text()), "terrain.contours")["findings"]
        self.assertGreater(told["lines"], 3)
        self.assertLess(told["smallest_interval_m"]["C"], told["smallest_interval_m"]["A"])
        self.assertIn(told["map_class"], ["A", "B", "C", "none"])
        self.assertGreater(told["c_factor"], 100)

    def test_a_model_against_itself_has_no_volume_and_against_a_design_its_area(self):
        dtm = self.made / "dtm.vrt"
        same = json.loads(swath("volumes", dtm, dtm, "--json").stdout)
        self.assertEqual((same["cut"], same["fill"]), (0, 0))
        high, higher = (json.loads(swath("volumes", dtm, "--design", h, "--json").stdout) for h in (2000, 2001))
        self.assertAlmostEqual(higher["fill"] - high["fill"], high["area"], delta=1e-6 * high["fill"])
        self.assertGreater(high["sigma_net"], 0)
        self.assertRegex(swath("volumes", dtm, "--design", "2000").stdout, r"(?m)^fill +[0-9.]+ m3 ")

    def test_volumes_refuse_what_they_cannot_answer(self):
        dtm = self.made / "dtm.vrt"
        self.assert_error(swath("volumes", dtm), 2, "--design")
        self.assert_error(swath("volumes", dtm, dtm, "--design", "3"), 2, "--design")
        self.assert_error(swath("volumes", self.made / "none.tif", "--design", "3"), 1, "none.tif")

    def test_a_profile_is_a_table_and_two_pictures(self):
        vrt = (self.made / "dtm.vrt").read_text()
        west, cell, _, north, _, _ = (float(v) for v in re.search(r"<GeoTransform>(.*)</GeoTransform>", vrt).group(1).split(","))
        columns, rows = (int(re.search(rf'raster{axis}Size="(\d+)"', vrt).group(1)) for axis in "XY")
        done = swath("profile", self.made / "points", "--dtm", self.made / "dtm.vrt", "--from", f"{west},{north}", "--to",
                     f"{west + cell * columns},{north - cell * rows}", "--output", self.folder / "cut", "--half-width", "3 m", "--json")
        self.assertEqual(done.returncode, 0, done.stderr)
        told = json.loads(done.stdout)[0]
        rows = (self.folder / "cut" / "profile.csv").read_text().splitlines()
        self.assertEqual(rows[0], "kind,station,offset,x,y,z,sigma,class")
        self.assertEqual(len(rows) - 1, told["points"] + told["terrain_samples"])
        self.assertEqual((self.folder / "cut" / "profile.png").read_bytes()[:4], b"\x89PNG")
        self.assertIn("<svg", (self.folder / "cut" / "profile.svg").read_text())

    def test_profiles_refuse_what_they_cannot_answer(self):
        points = self.made / "points"
        self.assert_error(swath("profile", points, "--output", self.folder / "cut"), 2, "--line")
        self.assert_error(swath("profile", points, "--from", "0,0", "--to", "x", "--output", self.folder / "cut"), 2, "'x'")
        self.assert_error(swath("profile", points, "--from", "0,0", "--to", "1,1", "--output", self.folder / "cut", "--half-width", "3"), 2,
                          "--half-width")
        self.assert_error(swath("profile", points, "--from", "0,0", "--to", "1,1", "--output", self.folder / "cut"), 1, "neither points")
        self.assertFalse((self.folder / "cut").exists())


if __name__ == "__main__":
    unittest.main()
