# SPDX-License-Identifier: GPL-3.0-or-later
"""Raw records in arrays: trajectory and points as a run on the files makes them."""
import csv
import unittest

import numpy as np
from support import InFolder

import swath

FLIGHT = {"seed": 5, "world": {"scene": "hills", "length": "300 m", "width": "200 m"}, "flight": {"lines": 2, "cross_lines": 0, "height": "250 m"},
          "scanner": {"prf": "3 kHz"}, "mounting": {"deliver": "truth"}, "output": {"formats": ["npy"]}}


def table(file):
    with open(file, newline="") as f:
        rows = list(csv.reader(f))
    return {name: np.array([r[k] for r in rows[1:]], float) for k, name in enumerate(rows[0])}


class Flight(InFolder):
    @classmethod
    def setUpClass(cls):
        import tempfile
        from pathlib import Path
        kept = tempfile.TemporaryDirectory(prefix="swath-test-")
        cls.addClassCleanup(kept.cleanup)
        cls.demo = Path(kept.name) / "demo"
        made = swath.simulate(cls.demo, **FLIGHT)
        assert made["lines"] == 2, made
        cls.survey = swath.read_survey(cls.demo / "survey.toml")
        cls.trajectory = swath.smooth(survey=cls.survey)

    def test_arrays_and_files_give_the_same_trajectory(self):
        imu, gnss = self.survey["imu"][0], self.survey["gnss"][0]
        columns = lambda entry, file: {ours: table(self.demo / file)[theirs] for ours, theirs in entry["columns"].items()}
        form = lambda entry: {k: v for k, v in entry.items() if k not in ("file", "columns")}
        given = swath.smooth(columns(imu, "imu.csv"), columns(gnss, "gnss.csv"), survey={k: self.survey[k] for k in ("imu_spec", "antenna")},
                             imu_format=form(imu), gnss_format=form(gnss))
        self.assertEqual(len(given), len(self.trajectory))
        for name in ("time", "latitude", "longitude", "height", "roll", "pitch", "heading", "sigma_roll"):
            np.testing.assert_array_equal(given[name], self.trajectory[name], name)
        self.assertLess(np.median(given.sigma_down), 0.1)
        self.assertEqual(given.array.dtype.names[0], "time")

    def test_points_are_those_of_the_pipeline(self):
        laser = np.load(self.demo / "laser.npy")
        entry = self.survey["laser"][0]
        columns = {ours: laser[theirs] for ours, theirs in entry["columns"].items()}
        form = {k: v for k, v in entry.items() if k not in ("file", "columns", "line")}
        points = swath.georeference(columns, self.trajectory, survey=self.survey, laser_format=form)
        stages = ["readers.imu", "readers.gnss", "trajectory.ins_gnss", "readers.laser", "georeference", "filters.returns", "writers.las"]
        swath.Pipeline({"stage": [{"type": s, **({"scale": 0.0001} if s == "writers.las" else {})} for s in stages]},
                       self.demo / "survey.toml", self.folder / "out").run()
        tiles = swath.read_points(str(self.folder / "out/points/*.laz"))
        self.assertEqual(len(points), len(tiles))
        ours = np.lexsort((points.return_number, points.gps_time))
        theirs = np.lexsort((tiles.return_number, tiles.gps_time))
        for axis in "xyz":
            np.testing.assert_allclose(points[axis][ours], tiles[axis][theirs], atol=6e-5)  # half a step of the file
        np.testing.assert_allclose(points.sigma_v[ours], tiles.sigma_v[theirs], atol=6e-5)
        truth = np.load(self.demo / "truth/returns.npy")
        self.assertEqual(len(truth), len(points), "every return is covered")

    def test_bad_input(self):
        gnss = {"time": [1.0, 2.0], "latitude": [48.0, 48.0], "longitude": [11.0, 11.0], "height": [500.0, 500.0]}
        e = self.fault(swath.smooth, {"time": [1.0], "giro_x": [0.0]}, gnss)
        self.assertEqual((e.where, e.hint), ("imu", "did you mean 'gyro_x'?"))
        e = self.fault(swath.smooth, survey=self.survey, outlier_limits="3")
        self.assertIn("swath.smooth", str(e))
        e = self.fault(swath.smooth, survey={})
        self.assertEqual((e.what, e.where), ("no IMU records", "swath.smooth: imu"))
        e = self.fault(swath.smooth, survey={k: v for k, v in self.survey.items() if k != "gnss"})
        self.assertEqual((e.what, e.where), ("no GNSS positions", "swath.smooth: gnss"))
        e = self.fault(swath.read_trajectory, {})
        self.assertEqual((e.what, e.where), ("no trajectory", "swath.read_trajectory: trajectory"))
        e = self.fault(swath.georeference, {"time": [1.0], "range": [500.0], "scan_angle": [0.0]}, self.trajectory)
        self.assertIn("crs", e.where)
        e = self.fault(swath.georeference, {"time": [1.0], "range": [500.0], "scan_angle": [0.0]}, self.trajectory, crs="EPSG:32632", survey={"scaner": {}})
        self.assertIn("did you mean 'scanner'", str(e))
        e = self.fault(swath.georeference, {"time": [1.0], "range": [500.0, 1.0]}, self.trajectory, crs="EPSG:32632")
        self.assertIn("one length", e.what)
        e = self.fault(swath.read_survey, self.folder / "no.toml")
        self.assertIn("no.toml", e.where)
        self.assertIn("flihgt", str(self.fault(swath.simulate, self.folder / "s", flihgt={})))


if __name__ == "__main__":
    unittest.main()
