# SPDX-License-Identifier: GPL-3.0-or-later
"""Stages as functions on points in memory."""
import inspect
import unittest

import numpy as np
from support import InFolder, hill, survey

import swath

CRS = "EPSG:32632"


class Functions(InFolder):
    @classmethod
    def setUpClass(cls):
        columns, cls.is_ground = hill()
        cls.points = swath.as_points(columns, CRS)
        cls.ground = swath.ground(cls.points)

    def test_ground_keeps_the_points_and_finds_the_ground(self):
        made = self.ground
        self.assertIs(made.x, self.points.x)
        self.assertNotIn("classification", self.points)
        found = made.classification == 2
        # Trees under 1.5 m beside the ground of 2 cm noise: a few per cent are confused.
        self.assertGreater(np.mean(found == self.is_ground), 0.97)
        self.assertEqual(made.counts["ground"], np.count_nonzero(found))
        self.assertEqual(made.ground_probability.dtype, np.float32)

    def test_every_filter_runs(self):
        for name in ("noise", "outlier", "smrf", "ptd", "robust", "pmf", "csf", "water", "classify", "key_points", "hag_dem"):
            with self.subTest(name):
                made = swath.FUNCTIONS[name](self.ground)
                self.assertEqual(len(made), len(self.points))
                self.assertIs(made.x, self.points.x)
        filters = {n for n in swath.stages() if n.startswith("filters.")}
        self.assertEqual(filters - {f"filters.{n}" for n in swath.FUNCTIONS}, set())

    def test_the_same_as_a_pipeline_on_the_file(self):
        self.points.write(self.folder / "cloud.laz")
        (self.folder / "survey.toml").write_text('[[points]]\nfile = "cloud.laz"\n')
        stages = ["readers.las", "filters.ground", "terrain.dtm", "writers.las", "writers.gdal"]
        swath.Pipeline({"stage": [{"type": s} for s in stages]}, self.folder / "survey.toml", self.folder / "out").run()
        tiles = swath.read_points(str(self.folder / "out/points/*.laz"))
        ours, theirs = np.argsort(self.ground.gps_time), np.argsort(tiles.gps_time)
        np.testing.assert_array_equal(tiles.classification[theirs], self.ground.classification[ours])
        dtm = swath.dtm(self.ground)
        whole = swath.read_grid(self.folder / "out/dtm.vrt")
        np.testing.assert_allclose(dtm.height, whole.at(*np.meshgrid(dtm.x, dtm.y)), atol=1e-4)  # COG holds float32, places differ by 1e-10 m

    def test_grids_and_contours(self):
        dtm = swath.dtm(self.ground, cell="2 m")
        self.assertEqual(dtm.cell, 2.0)
        self.assertEqual(dtm.height.shape, dtm.sigma.shape)
        x, y = np.meshgrid(dtm.x, dtm.y)
        truth = 400 + 0.05 * (x - 5e5) + 6 * np.exp(-((x - 500_150) ** 2 + (y - 5_300_150) ** 2) / 3000)
        error = (dtm.height - truth)[np.isfinite(dtm.height)]
        self.assertGreater(error.size, 15_000)
        self.assertLess(np.sqrt(np.mean(error ** 2)), 0.1)  # 2 cm of noise; low trees and the sides of boxes are the rest
        a = dtm.transform
        self.assertEqual((a[0] * 0.5 + a[2], a[4] * 0.5 + a[5]), (dtm.x[0], dtm.y[0]))
        dtm.write(self.folder / "dtm.tif")
        back = swath.read_grid(self.folder / "dtm.tif")
        np.testing.assert_array_equal(back.height, dtm.height)
        self.assertEqual(back.transform, dtm.transform)
        relief = swath.relief(self.ground, dtm={"cell": "2 m"})
        self.assertEqual(set(relief), {"slope", "hillshade"})
        lines = swath.contours(self.ground, interval="1 m", dtm={"cell": "2 m"})
        self.assertGreater(len(lines), 10)
        for line in lines:
            self.assertEqual(line.height, round(line.height))
        features = lines.__geo_interface__
        self.assertEqual(len(features["features"]), len(lines))
        self.assertEqual(features["features"][0]["geometry"]["type"], "LineString")
        for ending in ("gpkg", "dxf", "geojson"):
            lines.write(self.folder / f"lines.{ending}")
            self.assertGreater((self.folder / f"lines.{ending}").stat().st_size, 1000)

    def test_what_comes_before_is_added(self):
        classes = swath.classify(self.ground)
        found = classes.classification
        self.assertGreater(np.count_nonzero(found == 6), 500)  # boxes of 16 m side
        self.assertGreater(np.count_nonzero(np.isin(found, (3, 4, 5))), 1000)

    def test_without_a_crs_a_map_in_metres(self):
        local = swath.as_points({n: c - c[0] if n in "xyz" else c for n, c in self.points.columns.items()})
        made = swath.smrf(local)
        self.assertEqual(made.crs, "")
        self.assertGreater(np.count_nonzero(made.classification == 2), 20_000)

    def test_feet(self):
        """A cloud in US survey feet is the same cloud: cells, heights and slopes."""
        foot = 1200 / 3937
        feet = self.ground.with_columns(crs="EPSG:2263", **{n: self.ground[n] / foot - (0 if n == "z" else {"x": 660_000, "y": 17_180_000}[n]) for n in "xyz"})
        metres = swath.dtm(self.ground, cell="1 m").height
        made = swath.dtm(feet, cell="3 ft")
        self.assertAlmostEqual(made.cell, 3.0, 4)
        self.assertLess(abs(np.nanmedian(made.height) * foot - np.nanmedian(metres)), 0.05)
        slope, slope_m = swath.relief(feet)["slope"].height, swath.relief(self.ground)["slope"].height
        self.assertLess(abs(np.nanmedian(slope) - np.nanmedian(slope_m)), 0.3)  # degrees; not scaled by the foot

    def test_tiles_and_threads_change_nothing(self):
        for settings in ({"tile": "100 m"}, {"threads": 1}):
            np.testing.assert_array_equal(swath.ground(self.points, **settings).classification, self.ground.classification)

    def test_docstrings_name_every_option(self):
        for name, function in swath.FUNCTIONS.items():
            self.assertIn("Raises Error", function.__doc__)
        self.assertIn("cell:", swath.dtm.__doc__)
        self.assertIn("length", swath.dtm.__doc__)
        self.assertTrue(inspect.isfunction(swath.ground))

    def test_bad_input(self):
        small = self.points[:100]
        e = self.fault(swath.ground, small, wides="3 m")
        self.assertIn("did you mean 'widest'", e.hint + e.what)
        self.assertIn("swath.ground", e.where + e.what)
        e = self.fault(swath.dtm, small, cell=0.5)
        self.assertIn("unit", str(e))
        e = self.fault(swath.dtm, small, cell="5 deg")
        self.assertIn("cell", str(e))
        e = self.fault(swath.dtm, small, cell="-1 m")
        self.assertIn("cell", str(e))
        e = self.fault(swath.smrf, small[:0])
        self.assertIn("no points", e.what)
        e = self.fault(swath.smrf, small.with_columns(crs="EPSG:4326"))
        self.assertIn("map projection", e.what)
        e = self.fault(swath.smrf, {**small.columns, "x": np.full(100, np.inf)})
        self.assertIn("x: row 0", e.where)
        e = self.fault(swath.dtm, small, tile="a mile")
        self.assertIn("tile", str(e))
        e = self.fault(swath.ground, small, lattice=object())
        self.assertIn("object", e.what)


if __name__ == "__main__":
    unittest.main()
