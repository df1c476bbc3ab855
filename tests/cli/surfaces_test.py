# SPDX-License-Identifier: GPL-3.0-or-later
"""Contours, volumes and profiles of a run's products, as their user calls them."""
import json
import re
import struct
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

    def test_levels_make_a_curve(self):
        dtm = self.made / "dtm.vrt"
        base = json.loads(swath("volumes", dtm, "--design", "2000", "--json").stdout)
        rows = json.loads(swath("volumes", dtm, "--levels", "1998,2000,0.5", "--json").stdout)["levels"]
        self.assertEqual([r["level"] for r in rows], [1998, 1998.5, 1999, 1999.5, 2000])
        self.assertEqual(rows[-1]["volume"], base["fill"])
        self.assertEqual(rows[-1]["area"], base["fill_area"])
        self.assertAlmostEqual(rows[1]["volume"] - rows[0]["volume"], 0.5 * base["area"], delta=1e-6 * base["fill"])  # all of it is below
        self.assert_error(swath("volumes", dtm, "--levels", "5,4,1"), 2, "--levels")
        self.assert_error(swath("volumes", dtm, "--levels", "4,5,1", "--design", "3"), 2, "--levels")

    def test_volumes_refuse_what_they_cannot_answer(self):
        dtm = self.made / "dtm.vrt"
        self.assert_error(swath("volumes", dtm), 2, "--design")
        self.assert_error(swath("volumes", dtm, dtm, "--design", "3"), 2, "--design")
        self.assert_error(swath("volumes", self.made / "none.tif", "--design", "3"), 1, "none.tif")

    def test_a_profile_of_two_systems_is_refused(self):
        cloud = sorted((self.made / "points").glob("*.la[sz]"))[0]
        moved = self.folder / "moved"
        done = swath("copc", cloud, "--crs", "EPSG:32633", "-o", moved, "--quiet")
        self.assertEqual(done.returncode, 0, done.stderr)
        other = sorted(moved.rglob("*.laz"))[0]
        done = swath("profile", other, "--dtm", self.made / "dtm.vrt", "--from", "0,0", "--to", "9,9", "--output", self.folder / "cut")
        self.assert_error(done, 2, re.escape(str(other)) + ": is in .*33N.* while .*dtm.vrt is in .*32N", "hint: ")
        self.assertFalse((self.folder / "cut").exists())

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

    def test_sections_across_an_axis(self):
        vrt = (self.made / "dtm.vrt").read_text()
        west, cell, _, north, _, _ = (float(v) for v in re.search(r"<GeoTransform>(.*)</GeoTransform>", vrt).group(1).split(","))
        columns, rows = (int(re.search(rf'raster{axis}Size="(\d+)"', vrt).group(1)) for axis in "XY")
        x, y = west + 0.5 * cell * columns, north - 0.5 * cell * rows
        ends = ["--from", f"{x - 30},{y}", "--to", f"{x + 35},{y}"]
        call = ["profile", "--dtm", self.made / "dtm.vrt", *ends, "--stations", "10 m", "--width", "12 m", "--output", self.folder / "cut"]
        done = swath(*call, "--design", "2000", "--json")
        self.assertEqual(done.returncode, 0, done.stderr)
        told = json.loads(done.stdout)[0]
        self.assertEqual(told["sections"], 8)
        table = [r.split(",") for r in (self.folder / "cut" / "sections.csv").read_text().splitlines()]
        self.assertEqual(len(table), 9)
        self.assertEqual(table[1][4], "90.000")
        self.assertAlmostEqual(told["fill"], sum(float(r[table[0].index("fill_volume")]) for r in table[1:]), delta=0.1)
        self.assertEqual(told["cut"], 0)
        self.assert_error(swath(*call, "--design", "none.tif"), 1, "none.tif")
        self.assert_error(swath(*call, "--design", "nan"), 1, "nan")
        self.assert_error(swath(*[w if w != "10 m" else "0 m" for w in call]), 2, "--stations")
        self.assert_error(swath("profile", "--dtm", self.made / "dtm.vrt", *ends, "--design", "3", "--output", self.folder / "cut"), 2, "--stations")
        self.assert_error(swath(*call[:1], self.made / "points", *call[1:]), 2, "points are not read")

    def test_profiles_refuse_what_they_cannot_answer(self):
        points = self.made / "points"
        self.assert_error(swath("profile", points, "--output", self.folder / "cut"), 2, "--line")
        self.assert_error(swath("profile", points, "--from", "0,0", "--to", "x", "--output", self.folder / "cut"), 2, "'x'")
        self.assert_error(swath("profile", points, "--from", "0,0", "--to", "1,1", "--output", self.folder / "cut", "--half-width", "3"), 2,
                          "--half-width")
        self.assert_error(swath("profile", points, "--from", "0,0", "--to", "1,1", "--output", self.folder / "cut"), 1, "neither points")
        self.assertFalse((self.folder / "cut").exists())


class Crop(Case):
    simulated = SMALL

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.made = cls.class_folder / "made"
        done = swath("run", CONFIG, "--survey", cls.survey / "survey.toml", "--output", cls.made, "--quiet")
        if done.returncode != 0:
            raise AssertionError(done.stderr)
        corners = [struct.unpack_from("<4d", t.read_bytes(), 179) for t in sorted((cls.made / "points").glob("*.laz"))]  # max x, min x, max y, min y
        cls.west, cls.north = min(c[1] for c in corners), max(c[2] for c in corners)

    def config(self, options, *, writer='folder = "cut"'):
        """A cropped cloud: its config and survey; `options`: of filters.crop."""
        (self.folder / "crop.toml").write_text(f'[[stage]]\ntype = "readers.las"\n[[stage]]\ntype = "filters.crop"\n{options}\n[[stage]]\ntype = "writers.las"\n{writer}\n')
        (self.folder / "cloud.toml").write_text("".join(f'[[points]]\nfile = "{t}"\n' for t in sorted((self.made / "points").glob("*.laz"))))
        return self.folder / "crop.toml"

    def shape(self, name, kind, places, crs="32632"):
        ring = [[self.west + x, self.north - y] for x, y in places]
        (self.folder / name).write_text(json.dumps({
            "type": "FeatureCollection", "crs": {"type": "name", "properties": {"name": f"urn:ogc:def:crs:EPSG::{crs}"}},
            "features": [{"type": "Feature", "properties": {}, "geometry": {"type": kind, "coordinates": [ring] if kind == "Polygon" else ring}}]}))

    def test_points_outside_are_withheld_and_none_is_lost_for_any_tiling(self):
        self.shape("area.geojson", "Polygon", [(20, 20), (120, 30), (90, 90), (20, 20)])
        self.shape("axis.geojson", "LineString", [(0, 10), (150, 100)])
        config = self.config('polygons = "area.geojson"\naxis = "axis.geojson"\nbuffer = "5 m"')
        counts = []
        for tile in ("500 m", "40 m"):
            report = self.run_ok(self.folder / "cloud.toml", "--set", f"run.tile={tile}", config=config, out=self.folder / tile[:2])
            crop = stage(report, "filters.crop")
            self.assertEqual(crop["counts"]["in"], crop["counts"]["out"])
            kept, withheld = (crop["tally"][k]["count"] for k in ("points kept", "points withheld"))
            self.assertEqual(kept + withheld, crop["counts"]["in"])
            self.assertAlmostEqual(crop["findings"]["kept_share"], kept / (kept + withheld), places=6)
            counts.append((kept, withheld))
        self.assertEqual(counts[0], counts[1])
        self.assertGreater(min(counts[0]), 500)

    def test_what_cannot_be_cropped_is_one_error(self):
        cloud = self.folder / "cloud.toml"
        run = lambda options: swath("run", self.config(options), "--survey", cloud, "--output", self.out, "--quiet")
        self.assert_error(run(""), 2, "polygons or an axis must be given")
        self.assert_error(run('axis = "axis.geojson"'), 2, "buffer")
        self.assert_error(run('polygons = "none.gpkg"'), 1, "none.gpkg")
        self.shape("area.geojson", "Polygon", [(0, 0), (90, 90), (90, 0), (0, 80), (0, 0)])
        self.assert_error(run('polygons = "area.geojson"'), 1, "cross near", "feature 0")
        self.shape("area.geojson", "Polygon", [(9000, 20), (9120, 30), (9090, 90), (9000, 20)])
        self.assert_error(run('polygons = "area.geojson"'), 1, "no point is left", "area.geojson")
        self.assertFalse((self.out / "cut").exists())


if __name__ == "__main__":
    unittest.main()
