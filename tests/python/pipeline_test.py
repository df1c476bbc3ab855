# SPDX-License-Identifier: GPL-3.0-or-later
"""Pipelines from Python: reports, functions on tiles, Ctrl-C, bad input."""
import hashlib
import os
import signal
import subprocess
import sys
import threading
import time
import unittest

import numpy as np
from scipy import ndimage
from support import InFolder, hill

import swath

CRS = "EPSG:32632"
STAGES = ["readers.las", "filters.noise", "terrain.dtm", "writers.las", "writers.gdal"]
CELL = 2.0  # m
WINDOW = 25.0  # m
HALO = "60 m"


def opened_ground(tile):
    """A morphological ground filter of the user's: lowest point of each cell of the survey's lattice, opened, points near it are ground."""
    i = np.floor((tile.x + tile.origin[0]) / CELL).astype(int)
    j = np.floor((tile.y + tile.origin[1]) / CELL).astype(int)
    i0, j0 = i.min(), j.min()
    lowest = np.full((j.max() - j0 + 1, i.max() - i0 + 1), np.inf)
    np.minimum.at(lowest, (j - j0, i - i0), tile.z)
    size = int(WINDOW / CELL) | 1
    # Beside the halo nothing is known: the highest value keeps the opening from reading anything there.
    opened = ndimage.grey_dilation(ndimage.grey_erosion(lowest, size, mode="constant", cval=np.inf), size, mode="constant", cval=-np.inf)
    return np.where(tile.z - opened[j - j0, i - i0] < 0.5, 2, 1)[:tile.own]


class OnHill(InFolder):
    """A cloud of 600 m side, with runs on it."""

    def setUp(self):
        super().setUp()
        columns, self.is_ground = hill(150_000, side=600.0)
        self.points = swath.as_points(columns, CRS)
        self.points.write(self.folder / "cloud.laz")
        (self.folder / "survey.toml").write_text('[[points]]\nfile = "cloud.laz"\n')

    def pipeline(self, tile, out, stages=STAGES, threads=2):
        config = {"run": {"tile": tile}, "stage": [{"type": s} for s in stages]}
        return swath.Pipeline(config, self.folder / "survey.toml", self.folder / out, threads=threads)

    def classes(self, out):
        """Of all points, in the order of their times."""
        tiles = swath.read_points(str(self.folder / out / "points/*.laz"))
        self.assertEqual(len(tiles), len(self.points))
        return tiles.classification[np.argsort(tiles.gps_time)]


class Tilings(OnHill):
    def test_a_filter_of_scipy_gives_the_same_for_any_tiling(self):
        made, calls = {}, {}
        for tile in ("250 m", "500 m"):
            tiles = []

            def counted(t):
                tiles.append((t.own, len(t)))
                return opened_ground(t)

            report = self.pipeline(tile, f"out {tile}").run(on_tile=counted, halo=HALO, after="filters.noise")
            made[tile], calls[tile] = self.classes(f"out {tile}"), tiles
            self.assertEqual(sum(own for own, _ in tiles), len(self.points))
            self.assertEqual([s.type for s in report.stages][2], "python.on_tile")
        self.assertTrue(any(all_ > own for own, all_ in calls["250 m"]), "no tile had a halo")
        np.testing.assert_array_equal(made["250 m"], made["500 m"])
        ground = made["250 m"] == 2
        self.assertGreater(np.mean(ground == self.is_ground), 0.9)
        dtm = {t: swath.read_grid(self.folder / f"out {t}" / "dtm.vrt") for t in made}
        x, y = np.meshgrid(dtm["500 m"].x, dtm["500 m"].y)
        np.testing.assert_array_equal(dtm["250 m"].at(x, y), dtm["500 m"].height)


class OnTile(OnHill):
    def test_behind_the_ground_filter_by_default_and_in_place(self):
        seen = []

        def lift(tile):
            seen.append(set(np.unique(tile.classification)))
            with self.assertRaises(ValueError):
                tile.z[0] = 0.0  # only classes may be changed
            tile.classification[tile.classification == 2] = 8

        stages = ["readers.las", "filters.smrf", "writers.las"]
        report = self.pipeline("500 m", "out", stages).run(on_tile=lift, columns=["intensity"])
        self.assertEqual([s.type for s in report.stages], ["readers.las", "filters.smrf", "python.on_tile", "writers.las"])
        self.assertTrue(any(2 in s for s in seen))
        self.assertEqual(np.count_nonzero(self.classes("out") == 2), 0)
        self.assertGreater(np.count_nonzero(self.classes("out") == 8), 50_000)

    def test_views_outlive_the_call(self):
        kept = []
        self.pipeline("500 m", "out", ["readers.las", "writers.las"]).run(on_tile=lambda t: kept.append((t.x, t.own)))
        self.assertEqual(sum(own for _, own in kept), len(self.points))
        self.assertTrue(all(np.isfinite(x).all() for x, _ in kept))

    def test_the_same_bytes_again_and_nothing_stale(self):
        stages = ["readers.las", "writers.las"]
        digest = lambda out: [hashlib.sha256(p.read_bytes()).hexdigest() for p in sorted((self.folder / out / "points").glob("*.laz"))]
        constant = {"class": 5}
        function = lambda tile: np.full(tile.own, constant["class"])  # what it reads is not in its code
        self.pipeline("250 m", "a", stages).run(on_tile=function)
        self.pipeline("250 m", "b", stages).run(on_tile=function)
        self.assertEqual(digest("a"), digest("b"))
        kept = {"keep_work": True, "tile": "250 m"}
        for value in (5, 6):
            constant["class"] = value
            swath.Pipeline({"run": kept, "stage": [{"type": s} for s in stages]}, self.folder / "survey.toml", self.folder / "c").run(on_tile=function)
            self.assertTrue((self.classes("c") == value).all())

    def test_what_the_function_raises_or_returns_wrongly(self):
        run = lambda f, **named: self.pipeline("500 m", "out", ["readers.las", "writers.las"]).run(on_tile=f, **named)
        with self.assertRaisesRegex(ZeroDivisionError, "division"):
            run(lambda tile: 1 / 0)
        self.assertFalse((self.folder / "out").exists(), "nothing half-written stays")
        with self.assertRaisesRegex(AttributeError, "no column 'heigt'"):
            run(lambda tile: tile.heigt)
        self.assertIn("returned an array", self.fault(run, lambda tile: np.zeros(3, int)).what)
        self.assertIn("not classes", self.fault(run, lambda tile: np.full(tile.own, 300)).what)
        self.assertIn("not classes", self.fault(run, lambda tile: np.full(tile.own, 0.5)).what)
        self.assertIn("20 m", self.fault(run, print, halo="20").hint)
        self.assertIn("halo", self.fault(run, print, halo="-1 m").where)
        self.assertEqual(self.fault(run, print, columns=["intensiti"]).hint, "did you mean 'intensity'?")
        self.assertIn("filters.nois", self.fault(run, print, after="filters.nois").what)


class Runs(InFolder):
    def setUp(self):
        super().setUp()
        columns, _ = hill(30_000)
        swath.write_points(columns, self.folder / "cloud.laz", CRS)
        (self.folder / "survey.toml").write_text('name = "hill"\n[[points]]\nfile = "cloud.laz"\n')

    def test_the_report_is_typed(self):
        pipeline = swath.Pipeline("cloud", self.folder / "survey.toml", self.folder / "out", sets={"dtm.cell": "2 m", "run.tile": "200 m"})
        pipeline.check()
        self.assertEqual(next(s for s in pipeline.explain()["stages"] if s["type"] == "terrain.dtm")["options"]["cell"]["value"], "2 m")
        report = pipeline.run()
        self.assertEqual(report.survey, "hill")
        self.assertEqual(report.crs.name, "WGS 84 / UTM zone 32N")
        self.assertEqual(report.stages[0].counts.out, 30_000)
        dtm = report.stage("terrain.dtm")
        self.assertEqual(type(dtm).__name__, "TerrainDtmStage")
        self.assertLess(dtm.findings.void_share, 0.05)
        self.assertEqual(report.missed, [])
        self.assertEqual(swath.read_report(self.folder / "out").tree, report.tree)
        self.assertIn("swath.Pipeline", report.command)
        with self.assertRaises(KeyError):
            report.stage("terrain.dsm2")

    def test_bad_input(self):
        config = {"stage": [{"type": "readers.las"}, {"type": "terrain.dtm", "cel": "1 m"}]}
        e = self.fault(swath.Pipeline(config, self.folder / "survey.toml", self.folder / "out").run)
        self.assertIn("did you mean 'cell'", str(e))
        self.assertEqual(e.code, 2)
        e = self.fault(swath.Pipeline({"stage": [{"type": "terain.dtm"}]}).check)
        self.assertIn("did you mean 'terrain.dtm'", str(e))
        e = self.fault(swath.Pipeline({"stage": [{"type": "python.points"}]}).check)
        self.assertIn("python.points", str(e))
        e = self.fault(swath.Pipeline(self.folder / "no.toml").run)
        self.assertIn("no.toml", e.where)
        good = {"stage": [{"type": "readers.las"}, {"type": "writers.las"}]}
        e = self.fault(swath.Pipeline(good, output=self.folder / "out").run)
        self.assertIn("no survey", e.what)
        e = self.fault(swath.Pipeline(good, self.folder / "survey.toml", self.folder / "out", sets={"las.folder": 3}).run)
        self.assertIn("folder", str(e))
        self.assertIn("report", self.fault(swath.read_report, self.folder / "survey.toml").what + "report")
        self.assertFalse((self.folder / "out").exists())

    def test_other_threads_of_python_go_on(self):
        """The lock is free while a run works."""
        beats, stop = [], threading.Event()

        def beat():
            while not stop.is_set():
                beats.append(time.monotonic())
                time.sleep(0.005)

        thread = threading.Thread(target=beat)
        thread.start()
        begin = time.monotonic()
        swath.ground(swath.read_points(self.folder / "cloud.laz"))
        end = time.monotonic()
        stop.set()
        thread.join()
        during = [b for b in beats if begin <= b <= end]
        self.assertGreater(len(during), (end - begin) / 0.005 * 0.2)

    def test_ctrl_c(self):
        """KeyboardInterrupt ends a run soon, its work stays, and the same call goes on from it."""
        script = f"""
import sys, swath
sys.path.insert(0, {str(os.path.dirname(__file__))!r})
p = swath.Pipeline({{"run": {{"tile": "20 m"}}, "stage": [{{"type": "readers.las"}}, {{"type": "filters.ground"}}, {{"type": "writers.las"}}]}},
                   {str(self.folder / "survey.toml")!r}, {str(self.folder / "out")!r}, threads=1)
print("begins", flush=True)
try:
    p.run()
    print("done")
except KeyboardInterrupt:
    print("interrupted")
"""
        child = subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, text=True)
        self.assertEqual(child.stdout.readline(), "begins\n")
        until = time.monotonic() + 60
        while not list((self.folder / "out/.swath").glob("*filters.ground*/*.done")) and time.monotonic() < until and child.poll() is None:
            time.sleep(0.01)
        child.send_signal(signal.SIGINT)
        begin = time.monotonic()
        said = child.communicate(timeout=60)[0]
        self.assertEqual(said, "interrupted\n")
        self.assertLess(time.monotonic() - begin, 10)
        self.assertTrue((self.folder / "out/.swath").is_dir(), "its work stays")
        report = swath.Pipeline({"run": {"tile": "20 m"}, "stage": [{"type": s} for s in ("readers.las", "filters.ground", "writers.las")]},
                                self.folder / "survey.toml", self.folder / "out").run()
        self.assertGreater(report.pieces_resumed, 0)


if __name__ == "__main__":
    unittest.main()
