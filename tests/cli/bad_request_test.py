# SPDX-License-Identifier: GPL-3.0-or-later
"""Surveys and configs that ask for what cannot be, and surveys at the edge of what can be."""
import fcntl
import json
import os
import shutil
import subprocess
import unittest

from support import (CLOUD, CONFIG, SMALL, SMALLEST, SWATH, Case, cloud_survey, products, raster, sets, simulate, stage, substitute,
                     swath, truncate)


class Requests(Case):
    simulated = SMALLEST

    def setUp(self):
        super().setUp()
        self.toml = self.copy() / "survey.toml"

    def test_unit_missing(self):
        substitute(self.toml, 'angle_unit = "deg"\n', "")
        self.assert_bad_usage(self.toml, r"survey\.toml:\d+:\d+: laser\[1\]\.angle_unit: the unit .* is not stated")

    def test_bare_number(self):
        substitute(self.toml, 'roll = "', 'roll = 0.05 # "')
        self.assert_bad_usage(self.toml, r"survey\.toml:\d+:\d+: calibration\.roll: 0\.05: no unit", "deg, rad")

    def test_wrong_unit(self):
        self.assert_bad_usage(self.toml, r"--set.*ground.*widest", "5 s", more=["--set", "ground.widest=5 s"])

    def test_time_scale_missing(self):
        substitute(self.toml, 'scale = "gps_week"\nweek = 2317\n', "")
        self.assert_bad_usage(self.toml, r"survey\.toml:\d+:\d+: laser\[1\]\.time\.scale: the time scale is not stated")

    def test_unknown_key(self):
        substitute(self.toml, "[scanner]\n", '[scanner]\nmodle = "mirror"\n')
        self.assert_bad_usage(self.toml, r"survey\.toml:6:\d+: scanner\.modle: unknown key \(did you mean 'model'\?\)")

    def test_broken_toml(self):
        substitute(self.toml, "[scanner]", "[scanner")
        self.assert_bad_usage(self.toml, r"survey\.toml:\d+:\d+")

    def test_broken_json(self):
        config = self.folder / "a.json"
        config.write_text('{"stage": [}')
        self.assert_bad_usage(self.toml, r"a\.json:1:\d+", config=config)

    def test_unknown_crs(self):
        for crs in ("EPSG:99999", "no such place", ""):
            with self.subTest(crs=crs):
                toml = self.folder / "survey" / "other.toml"
                toml.write_text(self.toml.read_text().replace("EPSG:32632", crs))
                self.assert_bad_usage(toml, r"other\.toml:3:7: crs: ")

    def test_missing_geoid_grid(self):
        # No grid of the German quasigeoid comes with PROJ's packages; a path of its own holds it where one is installed.
        substitute(self.toml, "EPSG:32632", "EPSG:25832+7837")
        self.assert_bad_usage(self.toml, r"survey\.toml: crs: .* needs the grid file", "hint: ")
        self.assertIn("needs the grid file", swath("check", CONFIG, "--survey", self.toml).stderr)

    def test_geographic_crs(self):
        substitute(self.toml, "EPSG:32632", "EPSG:4326")
        self.assert_bad_usage(self.toml, r"survey\.toml: crs: .* is not a map projection", "hint: ")

    def test_another_end_of_the_world(self):
        substitute(self.toml, "EPSG:32632", "EPSG:32655")
        self.assert_bad_usage(self.toml, "EPSG:32655: the trajectory lies .* degrees outside the area of use", "hint: ")

    def test_wrong_reader(self):
        self.assert_bad_usage(self.toml, r"names no \[\[points\]\] file", "hint: ", config=CLOUD)

    def test_no_records_at_all(self):
        npy = (self.toml.parent / "laser.npy").read_bytes()
        begin = 10 + int.from_bytes(npy[8:10], "little")
        shape = npy[:begin]
        at = shape.index(b"'shape': (") + 10
        end = shape.index(b",", at)
        (self.toml.parent / "laser.npy").write_bytes(shape[:at] + b"0".zfill(end - at) + shape[end:])
        self.assert_bad_data(self.toml, r"survey\.toml: no laser return to work on")

    def test_lines_at_other_times(self):
        text = self.toml.read_text().replace('start = "4740', 'start = "4840').replace('end = "4740', 'end = "4840')
        self.toml.write_text(text)
        self.assert_bad_data(self.toml, r"no laser return to work on: records from .* flight lines from")

    def test_two_runs_in_one_folder(self):
        (self.out / ".swath").mkdir(parents=True)
        with open(self.out / ".swath" / "lock", "w") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            done = swath("run", CONFIG, "--survey", self.toml, "--output", self.out, "--quiet")
            self.assert_error(done, 2, "another run is at work", "hint: ")
            self.assertTrue((self.out / ".swath" / "lock").exists(), "the other run's work is not touched")
        self.run_ok(self.toml)

    def test_two_runs_started_together(self):
        command = [SWATH, "run", CONFIG, "--survey", self.toml, "--output", self.out, "--quiet"]
        runs = [subprocess.Popen(command, stderr=subprocess.PIPE, text=True) for _ in range(2)]
        told = [(run.communicate(timeout=120)[1], run.returncode) for run in runs]
        self.assertIn(0, [code for _, code in told])
        for text, code in told:
            if code != 0:
                self.assertEqual(code, 2)
                self.assertIn("another run is at work", text)
        self.run_ok(self.toml, out=self.folder / "alone")
        self.assertEqual(products(self.out), products(self.folder / "alone"))


class Systems(Case):
    """Folders that cannot be written."""
    simulated = SMALLEST

    def test_output_that_is_a_file(self):
        file = self.folder / "file"
        file.write_text("kept")
        for command in ("run", "check"):
            done = swath(command, CONFIG, "--survey", self.survey / "survey.toml", "--output", file, "--quiet")
            self.assert_error(done, 2, "file: the output is a file; products go to a folder", "hint: name a folder by --output")
        self.assertEqual(file.read_text(), "kept")

    def test_output_below_a_file(self):
        (self.folder / "file").write_text("not a folder")
        done = swath("run", CONFIG, "--survey", self.survey / "survey.toml", "--output", self.folder / "file" / "out", "--quiet")
        self.assert_error(done, 1, "cannot make the output folder", "file/out")
        self.assertEqual((self.folder / "file").read_text(), "not a folder")
        done = swath("simulate", self.folder / "file" / "survey", "--quiet")
        self.assert_error(done, 1, "file/survey")

    @unittest.skipIf(os.geteuid() == 0, "root may write everywhere")
    def test_folder_without_rights(self):
        os.chmod(self.folder, 0o500)
        try:
            done = swath("run", CONFIG, "--survey", self.survey / "survey.toml", "--output", self.out, "--quiet")
            self.assert_error(done, 1, "Permission denied", "hint: ")
        finally:
            os.chmod(self.folder, 0o700)

    def test_bad_data_leaves_earlier_products_alone(self):
        self.run_ok(self.survey / "survey.toml")
        before = products(self.out)
        report = (self.out / "report.json").read_bytes()
        survey = self.copy()
        truncate(survey / "laser.npy", -10)
        done = swath("run", CONFIG, "--survey", survey / "survey.toml", "--output", self.out, "--quiet")
        self.assert_error(done, 1, r"laser\.npy")
        self.assertEqual(products(self.out), before)
        self.assertEqual((self.out / "report.json").read_bytes(), report)


class Clouds(Case):
    """Point clouds that are hardly any."""

    def run_cloud(self, points):
        return self.run_ok(cloud_survey(self.folder / "survey", points), config=CLOUD)

    def test_no_point(self):
        toml = cloud_survey(self.folder / "survey", [])
        self.assert_bad_data(toml, "the file has no points", config=CLOUD)

    def refuse_cloud(self, points):
        toml = cloud_survey(self.folder / "survey", points)
        self.assert_bad_data(toml, "no triangle of ground points", "on one line", config=CLOUD)
        # What needs no surface is made all the same.
        config = self.folder / "points.toml"
        config.write_text('[[stage]]\ntype = "readers.las"\n[[stage]]\ntype = "writers.las"\n')
        report = self.run_ok(toml, config=config)
        self.assertEqual(stage(report, "writers.las")["counts"], {"in": len(points), "out": len(points)})

    def test_one_point(self):
        toml = cloud_survey(self.folder / "survey", [(500010.5, 5300010.5, 100.0)])
        self.assert_bad_data(toml, r"the only point is noise \(class 7 or 18\)", config=CLOUD)  # it is isolated

    def test_collinear_points(self):
        self.refuse_cloud([(500000.5 + i, 5300000.5 + i, 100.0) for i in range(200)])
        shutil.rmtree(self.out)
        self.refuse_cloud([(500000.5, 5300000.5 + i, 100.0) for i in range(200)])

    def plane(self):
        return [(500000.25 + 0.5 * i, 5300000.25 + 0.5 * j, 100 + 0.05 * i) for j in range(80) for i in range(80)]

    def test_duplicate_points(self):
        once = self.run_cloud(self.plane())
        heights = raster(self.out / "dtm.vrt")
        twice = self.run_ok(cloud_survey(self.folder / "twice", [p for p in self.plane() for _ in range(2)]), config=CLOUD,
                            out=self.folder / "twice-out")
        self.assertEqual(stage(twice, "writers.las")["counts"]["out"], 2 * stage(once, "writers.las")["counts"]["out"])
        again = raster(self.folder / "twice-out" / "dtm.vrt")
        self.assertEqual(heights.keys(), again.keys())
        for place, height in heights.items():
            self.assertAlmostEqual(height, again[place], delta=1e-3)  # the LAS file's own resolution
        same = "ground points at the same place as a lower or equal one"
        self.assertNotIn(same, stage(once, "terrain.dtm")["tally"])
        ground = stage(once, "filters.ground")["tally"]["ground"]["count"]
        self.assertEqual(stage(twice, "terrain.dtm")["tally"][same]["count"], ground)

    def test_points_farther_apart_than_voids_are_measured(self):
        report = self.run_cloud([(500000.25 + 4 * i, 5300000.25 + 4 * j, 100 + 0.2 * i) for j in range(40) for i in range(40)])
        found = stage(report, "quality.swath")["findings"]
        self.assertRegex(found["no_voids"], "m apart, farther than 3 m: .* quality.swath.anps")
        self.assertNotIn("voids", found)
        judged = self.run_ok(self.folder / "survey" / "survey.toml", "--set", "quality.swath.anps=5m", config=CLOUD, out=self.folder / "judged")
        self.assertEqual(stage(judged, "quality.swath")["findings"]["voids"], 0)

    def test_all_points_at_one_place(self):
        self.refuse_cloud([(500010.5, 5300010.5, 100.0)] * 50)

    def test_no_usable_point(self):
        for code, words in ((0x87, "all 1600 points are withheld: "), (7, r"all 1600 points are noise \(class 7 or 18\)")):
            with self.subTest(code=code):
                toml = cloud_survey(self.folder / "survey", self.plane()[:1600])
                cloud = self.folder / "survey" / "cloud.las"
                data = bytearray(cloud.read_bytes())
                data[227 + 15::28] = bytes([code]) * 1600  # class and flags of format 1
                cloud.write_bytes(data)
                self.assert_bad_data(toml, words, "hint: ", config=CLOUD)

    def test_no_crs_in_the_file(self):
        toml = cloud_survey(self.folder / "survey", self.plane())
        toml.write_text('crs = "EPSG:32632"\n[[points]]\nfile = "cloud.las"\n')
        self.assert_bad_data(toml, r"cloud\.las: states no CRS", config=CLOUD)

    def test_degrees_as_metres(self):
        # Geographic coordinates under a projected CRS: all points fall into one cell; a geographic survey CRS is refused.
        toml = cloud_survey(self.folder / "survey", self.plane(), crs="EPSG:4326")
        self.assert_bad_usage(toml, "not a map projection", config=CLOUD)

    def test_feet(self):
        # The same plane in metres and in US survey feet.
        foot = 1200 / 3937
        metres = self.plane()
        self.run_cloud(metres)
        feet = [(6000000 + (x - 500000) / foot, 2000000 + (y - 5300000) / foot, z / foot) for x, y, z in metres]
        report = self.run_ok(cloud_survey(self.folder / "feet", feet, crs="EPSG:2225"), "--set", "writers.las.compress=false",
                             config=CLOUD, out=self.folder / "feet-out")
        self.assertIn("ftUS", report["crs"]["name"])
        told = json.loads(swath("info", next((self.folder / "feet-out" / "points").glob("*.las")), "--json").stdout)
        self.assertIn("US survey foot", json.dumps(told))
        heights = raster(self.folder / "feet-out" / "dtm.vrt")
        self.assertGreater(len(heights), 0.8 * 38 * 38)
        places = sorted(heights)
        step = min(b[0] - a[0] for a, b in zip(places, places[1:]) if b[0] > a[0])
        self.assertAlmostEqual(step, 1 / foot, delta=0.002, msg="a cell of 1 m measures 3.28 ft")
        for (x, y), z in heights.items():
            expected = (100 + 0.05 * ((x - 6000000) * foot - 0.25) / 0.5) / foot
            self.assertAlmostEqual(z, expected, delta=0.01, msg=f"height in feet at {x} {y}")
        tif = next(p for p in (self.folder / "feet-out" / "dtm").glob("*.tif") if "quality" not in p.name)
        self.assertRegex(swath("info", tif).stdout, r"(?i)foot|ft")


class Places(Case):
    def test_the_edge_of_a_zone(self):
        for longitude in ("11.9995 deg", "12.0005 deg"):
            with self.subTest(longitude=longitude):
                survey = simulate(self.folder / longitude, SMALLEST + [f"longitude={longitude}"])
                report = self.run_ok(survey / "survey.toml", out=self.folder / (longitude + " out"))
                self.assertLess(stage(report, "report.truth")["findings"]["rms_3d"], 0.1)
                if longitude.startswith("12"):
                    tally = stage(report, "readers.trajectory")["tally"]
                    self.assertTrue([k for k in tally if "outside the CRS's area of use" in k], tally)

    def test_the_neighbouring_zone_is_told(self):
        survey = simulate(self.folder / "survey", SMALLEST)
        substitute(survey / "survey.toml", "EPSG:32632", "EPSG:32633")
        text = (survey / "survey.toml").read_text()
        (survey / "survey.toml").write_text(text[:text.index("[truth]")])
        report = self.run_ok(survey / "survey.toml")
        self.assertTrue([k for k in stage(report, "readers.trajectory")["tally"] if "outside the CRS's area of use" in k])

    def test_raw_records_to_feet(self):
        place = ["latitude=41 deg", "longitude=-122 deg", "crs=EPSG:32610"]
        survey = simulate(self.folder / "survey", SMALLEST + place)
        text = (survey / "survey.toml").read_text()
        text = text[:text.index("[truth]")]
        (survey / "metres.toml").write_text(text)
        # The datum of the states' planes is not WGS 84: a shift of unknown size is an error, never passed over.
        (survey / "nad83.toml").write_text(text.replace("EPSG:32610", "EPSG:2225"))
        (survey / "feet.toml").write_text(text.replace(
            "EPSG:32610", "+proj=lcc +lat_0=39.3333333333333 +lon_0=-122 +lat_1=41.6666666666667 +lat_2=40 +x_0=2000000.0001016 "
            "+y_0=500000.0001016 +datum=WGS84 +units=us-ft +no_defs"))
        self.run_ok(survey / "metres.toml", out=self.folder / "metres")
        self.run_ok(survey / "feet.toml", out=self.folder / "feet")
        metres, feet = raster(self.folder / "metres" / "dtm.vrt"), raster(self.folder / "feet" / "dtm.vrt")
        foot = 1200 / 3937
        step = min(b[0] - a[0] for a, b in zip(sorted(feet), sorted(feet)[1:]) if b[0] > a[0])
        self.assertAlmostEqual(step * foot, 1.0, delta=1e-3)
        self.assertAlmostEqual(len(feet) / len(metres), 1.0, delta=0.02)
        # Heights have no unit of their own in this CRS: they stay metres, as the survey file's height_unit says.
        self.assertAlmostEqual(sum(feet.values()) / len(feet), sum(metres.values()) / len(metres), delta=0.05)


if __name__ == "__main__":
    unittest.main()
