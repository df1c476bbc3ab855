# SPDX-License-Identifier: GPL-3.0-or-later
"""Breaklines and further grids through a whole run, cut into tiles of different sizes."""
import json
import unittest

from support import Case, cloud_survey, raster, stage, swath

EAST, NORTH = 500000.0, 5300000.0
LAKE = [(80, 60), (160, 66), (150, 120), (84, 110)]
WALL = [(20.3, 150.2, 108.0), (120.7, 170.4, 111.0), (260.1, 161.9, 110.0)]
CONFIG = "".join(f'[[stage]]\ntype = "{s}"\n{more}\n' for s, more in (
    ("readers.las", ""), ("terrain.breaklines", "classes = [0]\n"), ("terrain.dtm", "classes = [0]\n"), ("terrain.dsm", 'method = "spike_free"\nfreeze = "3 m"\nmax_gap = "6 m"\n'),
    ("terrain.canopy", ""), ("terrain.relief", ""), ("terrain.density", ""), ("terrain.intensity", ""), ("writers.gdal", ""),
    ("terrain.contours", 'interval = "0.5 m"\n'),
    ("terrain.contours", 'interval = "0.5 m"\nname = "of_tin"\nsource = "tin"\ntin = {classes = [0], cell = "1 m"}\n')))
GRIDS = ("dtm", "dsm", "canopy", "slope", "hillshade", "pulse_density", "return_density", "intensity")


def ground(x, y):
    return 100.0 + 0.02 * x + (3.0 if y > 160 else 0.0)


def in_lake(x, y):
    sides = zip(LAKE, LAKE[1:] + LAKE[:1])
    return all((bx - ax) * (y - ay) - (by - ay) * (x - ax) > 0 for (ax, ay), (bx, by) in sides)


def geojson(file, kind, *shapes):
    """Lines or polygons in the survey's own CRS."""
    place = [[[EAST + v[0], NORTH + v[1], *v[2:]] for v in shape] for shape in shapes]
    geometries = [{"type": kind, "coordinates": [p + p[:1]] if kind == "Polygon" else p} for p in place]
    file.write_text(json.dumps({"type": "FeatureCollection", "crs": {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::32632"}},
                                "features": [{"type": "Feature", "properties": {}, "geometry": g} for g in geometries]}))


class Breaklines(Case):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        points = [(EAST + x + 0.37, NORTH + y + 0.21, ground(x + 0.37, y + 0.21)) for y in range(0, 200, 2) for x in range(0, 300, 2)
                  if not in_lake(x, y)]
        cls.survey = cloud_survey(cls.class_folder / "survey", points)
        geojson(cls.survey.parent / "lake.geojson", "Polygon", LAKE)
        geojson(cls.survey.parent / "wall.geojson", "LineString", WALL)
        with cls.survey.open("a") as toml:
            toml.write('\n[[breaklines]]\nfile = "lake.geojson"\nkind = "lake"\n\n[[breaklines]]\nfile = "wall.geojson"\nsigma = "1 cm"\n')
        cls.config = cls.class_folder / "config.toml"
        cls.config.write_text(CONFIG)
        cls.out_of, cls.report = {}, {}
        for tile in (130, 1000):
            cls.out_of[tile] = cls.class_folder / str(tile)
            done = swath("run", cls.config, "--survey", cls.survey, "--output", cls.out_of[tile], "--quiet", "--set", f"run.tile={tile} m")
            assert done.returncode == 0, done.stderr
            cls.report[tile] = json.loads((cls.out_of[tile] / "report.json").read_text())

    def test_every_grid_is_the_same_for_every_tiling(self):
        for name in GRIDS:
            a, b = (raster(self.out_of[t] / f"{name}.vrt") for t in (130, 1000))
            self.assertGreater(len(b), 10000, name)
            inside = [p for p in b if p in a]
            self.assertEqual([p for p in inside if a[p] != b[p]], [], name)
            if name in ("dtm", "dsm", "canopy", "slope", "hillshade", "intensity"):
                self.assertEqual(len(a.keys() ^ b.keys()), 0, name)

    def test_a_lake_wider_than_a_tile_is_whole(self):
        # Tiles of 20 m, no point within 10 m of those in the lake's middle.
        models = []
        for tile in (20, 1000):
            out = self.class_folder / f"wide_{tile}"
            done = swath("run", self.config, "--survey", self.survey, "--output", out, "--quiet", "--set", f"run.tile={tile} m",
                         "--set", "dtm.max_edge=5 m")
            self.assertEqual(done.returncode, 0, done.stderr)
            models.append(raster(out / "dtm.vrt"))
        self.assertGreater(sum(in_lake(x - EAST, y - NORTH) for x, y in models[1]), 3000)
        self.assertEqual(models[0], models[1])

    def test_lake_is_flat_at_the_level_of_its_shore(self):
        water = stage(self.report[1000], "terrain.breaklines")["findings"]["waters"][0]
        self.assertGreater(water["shore_points"], 50)
        self.assertAlmostEqual(water["lowest_m"], water["highest_m"], 9)
        dtm = raster(self.out_of[1000] / "dtm.vrt")
        heights = {v for (x, y), v in dtm.items() if in_lake(x - EAST, y - NORTH)}
        self.assertEqual(len(heights), 1)
        self.assertAlmostEqual(heights.pop(), water["lowest_m"], 4)

    def test_terrain_passes_through_the_wall(self):
        dtm = raster(self.out_of[1000] / "dtm.vrt")
        near = 0
        for (x, y), v in dtm.items():
            for (ax, ay, az), (bx, by, bz) in zip(WALL, WALL[1:]):
                dx, dy, px, py = bx - ax, by - ay, x - EAST - ax, y - NORTH - ay
                t = (px * dx + py * dy) / (dx * dx + dy * dy)
                if 0 < t < 1 and abs(px * dy - py * dx) < 0.02 * (dx * dx + dy * dy) ** 0.5:
                    near += 1
                    self.assertLess(abs(v - az - t * (bz - az)), 0.02 * 8 / 0.5)  # 2 cm beside a line that stands up to 8 m over the ground 0.5 m away
        self.assertGreater(near, 3)

    def test_contours_of_the_tin_hold_lake_and_wall_as_those_of_the_grid_do(self):
        # The TIN read on the grid's own lattice.
        of_grid, of_tin = (json.loads((self.out_of[1000] / f"{name}.geojson").read_text())["features"] for name in ("contours", "of_tin"))
        self.assertGreater(len(of_grid), 5)
        self.assertEqual(of_grid, of_tin)

    def test_lines_that_cross_at_different_heights_are_named(self):
        geojson(self.survey.parent / "stair.geojson", "LineString", [(60, 140, 101.0), (62, 190, 101.0)])
        survey = self.survey.parent / "crossing.toml"
        survey.write_text(self.survey.read_text() + '\n[[breaklines]]\nfile = "stair.geojson"\n')
        self.assert_bad_data(survey, "meet at different heights", "wall.geojson", "stair.geojson", "feature", r"x 50006\d", config=self.config)

    def test_stage_without_files_is_refused(self):
        survey = self.survey.parent / "none.toml"
        survey.write_text(self.survey.read_text().split("[[breaklines]]")[0])
        self.assert_bad_usage(survey, r"terrain\.breaklines", config=self.config)


if __name__ == "__main__":
    unittest.main()
