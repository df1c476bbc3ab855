# SPDX-License-Identifier: GPL-3.0-or-later
"""One wild value in a file: it is left out and counted, and costs no time; what is rare but right stays."""
import json
import math
import random
import struct
import time
import unittest

from support import CLOUD, CONFIG, FULL, SMALL, Case, cloud_survey, edit_line, f8, las_records, patch, stage, swath

MOST_SECONDS = 60.0  # on a busy machine; one wild coordinate took minutes or all memory
TEXT = SMALL + ['output.formats=["csv"]', "output.trajectory=text"]


def ground(n=4000, side=60.0, x0=500000.0, y0=5400000.0):
    draw = random.Random(5)
    return [(x0 + draw.uniform(0, side), y0 + draw.uniform(0, side), 300 + draw.gauss(0, 0.02)) for _ in range(n)]


class Wild(Case):
    def run_timed(self, survey, *more, **keywords):
        begin = time.monotonic()
        report = self.run_ok(survey, *more, **keywords)
        self.assertLess(time.monotonic() - begin, MOST_SECONDS)
        return report

    def assert_left_out(self, part, what, count=1, example=""):
        self.assertIn(what, part.get("tally", {}), part)
        self.assertEqual(part["tally"][what]["count"], count)
        if example:
            self.assertRegex(part["tally"][what]["examples"][0], example)


class WildClouds(Wild):
    def test_points_alone_far_away(self):
        for x, y in ((1e5, 0), (1e6, -1e6), (2e6, 2e6)):
            with self.subTest(x=x, y=y):
                points = ground()
                points[100] = (points[100][0] + x, points[100][1] + y, 300)
                reader = stage(self.run_timed(cloud_survey(self.folder / "c", points), config=CLOUD), "readers.las")
                self.assert_left_out(reader, "points alone far from all others of their file, left out", 1, "record 100: x ")
                self.assertEqual(reader["counts"], {"in": 4000, "out": 3999})
                self.assertEqual(len(list((self.out / "points").glob("*.laz"))), 1)

    def test_heights_that_nothing_has(self):
        points = ground()
        points[7] = points[7][:2] + (-2e6,)
        points[8] = points[8][:2] + (2.5e4,)
        reader = stage(self.run_timed(cloud_survey(self.folder / "c", points), config=CLOUD), "readers.las")
        self.assert_left_out(reader, "points outside the survey's heights, left out", 2, r"record 7: .*z -2e\+06")

    def test_a_header_whose_box_is_wrong_changes_nothing(self):
        right = cloud_survey(self.folder / "right", ground())
        self.run_timed(right, "--set", "writers.las.compress=false", config=CLOUD)
        records = las_records(self.out / "points")
        for box in ((1e9, -1e9) * 3, (math.nan,) * 6, (1.0, 0.0) * 3, (math.inf, -math.inf) * 3):
            with self.subTest(box=box):
                wrong = cloud_survey(self.folder / "wrong", ground())
                patch(wrong.parent / "cloud.las", 179, struct.pack("<6d", *box))
                self.run_timed(wrong, "--set", "writers.las.compress=false", config=CLOUD, out=self.folder / "out2")
                self.assertEqual(las_records(self.folder / "out2" / "points"), records)

    def test_impossible_times_are_taken_as_unknown(self):
        for value in (1e18, -5e9, math.nan, math.inf):
            with self.subTest(value=value):
                survey = cloud_survey(self.folder / "c", ground())
                patch(survey.parent / "cloud.las", 6, b"\x01\x00")
                patch(survey.parent / "cloud.las", 227 + 28 * 100 + 20, f8(value))
                reader = stage(self.run_timed(survey, config=CLOUD), "readers.las")
                self.assertEqual(reader["tally"]["points with an impossible time, taken as unknown"]["count"], 1)
                self.assertEqual(reader["counts"], {"in": 4000, "out": 4000})

    def test_few_points_over_a_wide_area_stay(self):
        draw = random.Random(3)
        points = ground(3000, 50.0) + [(500000 + draw.uniform(-12e3, 12e3), 5400000 + draw.uniform(-12e3, 12e3), 300) for _ in range(12)]
        reader = stage(self.run_ok(cloud_survey(self.folder / "c", points), config=CLOUD), "readers.las")
        self.assertEqual(reader["counts"], {"in": 3012, "out": 3012})

    def test_a_stated_area_is_kept_to(self):
        survey = cloud_survey(self.folder / "c", ground())
        survey.write_text(survey.read_text().replace("[[points]]", "[area]\neast = 500040.0\nhighest = \"1 km\"\n\n[[points]]"))
        reader = stage(self.run_ok(survey, config=CLOUD), "readers.las")
        left_out = sum(p[0] > 500040.0005 for p in ground())
        self.assert_left_out(reader, "points outside the survey's area, left out", left_out)
        self.assertEqual(reader["counts"], {"in": 4000, "out": 4000 - left_out})


class WildBreaklines(Wild):
    def breakline_run(self, coordinates, kind, shape):
        survey = cloud_survey(self.folder / "c", ground())
        survey.write_text(survey.read_text() + f'\n[[breaklines]]\nfile = "b.geojson"\nkind = "{kind}"\n')
        text = json.dumps({"type": "FeatureCollection", "crs": {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::32632"}},
                           "features": [{"type": "Feature", "properties": {}, "geometry": {"type": shape, "coordinates": coordinates}}]})
        (survey.parent / "b.geojson").write_text(text)
        config = self.folder / "breaklines.toml"
        config.write_text(CLOUD.read_text().replace('[[stage]]\ntype = "terrain.dtm"', '[[stage]]\ntype = "terrain.breaklines"\n\n[[stage]]\ntype = "terrain.dtm"'))
        return stage(self.run_timed(survey, config=config), "terrain.breaklines")

    def test_a_vertex_far_away(self):
        what = "breakline vertices outside the survey's area, left out"
        for far in (1e6, 1e12, 1e300, math.nan):
            with self.subTest(far=far):
                line = [[500010 + 3 * i, 5400010 + 3 * i, 300] for i in range(12)]
                line[5][0] = far
                self.assert_left_out(self.breakline_run(line, "breakline", "LineString"), what, 1, r"b\.geojson")
                ring = [[500030 + 20 * math.cos(0.5 * i), 5400030 + 20 * math.sin(0.5 * i), 299] for i in range(12)]
                ring[5][:2] = far, 6e6
                ring.append(ring[0])
                self.assert_left_out(self.breakline_run([ring], "lake", "Polygon"), what)

    def test_a_height_that_nothing_has(self):
        line = [[500010, 5400010, 300], [500020, 5400020, 300], [500030, 5400030, 1e6], [500040, 5400040, 300], [500050, 5400050, 300]]
        self.assert_left_out(self.breakline_run(line, "breakline", "LineString"), "breakline vertices outside the survey's area, left out")

    def test_profiles(self):
        self.run_ok(cloud_survey(self.folder / "c", ground()), config=CLOUD)
        for x in ("9e7", "1e7"):
            begin = time.monotonic()
            done = swath("profile", self.out / "points", "--dtm", self.out / "dtm.vrt", "--from", "500010,5400030", "--to", f"{x},5400030",
                         "--output", self.folder / "p")
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertLess(time.monotonic() - begin, MOST_SECONDS)
            rows = (self.folder / "p" / "profile.csv").read_text().split("\n")
            self.assertGreater(sum(r.startswith("terrain") for r in rows), 80)
        lines = self.folder / "lines.csv"
        for x in ("1e9", "1e300"):
            lines.write_text(f"profile,x,y\na,500010,5400030\na,{x},5400030\na,500050,5400030\n")
            done = swath("profile", self.out / "points", "--dtm", self.out / "dtm.vrt", "--line", lines, "--output", self.folder / "p")
            self.assertEqual(done.returncode, 0, done.stderr)
            rows = (self.folder / "p" / "a.csv").read_text().split("\n")
            self.assertGreater(sum(r.startswith("terrain") for r in rows), 60)
        done = swath("profile", self.out / "points", "--from", "500010,5400030", "--to", "1e9,5400030", "--output", self.folder / "q")
        self.assert_error(done, 1)


class WildRecords(Wild):
    simulated = TEXT

    def test_laser(self):
        for column, value, what in ((0, "1000000000", "records with an impossible time"), (0, "-5", "records with an impossible time"),
                                    (0, "600000", "records with an impossible time"), (0, "nan", "records without a valid time or line"),
                                    (1, "nan", "records without a valid time or line"), (2, "nan", "records with an invalid range or angle"),
                                    (2, "1e9", "records with an invalid range or angle"),
                                    (3, "inf", "records with an invalid range or angle"), (3, "1e30", "records with a range over 100 km")):
            for row in (1, 500, -2) if value in ("1000000000", "nan") and column == 0 else (500,):
                with self.subTest(column=column, value=value, row=row):
                    folder = self.copy()
                    edit_line(folder / "laser.csv", row, column, value)
                    reader = stage(self.run_timed(folder / "survey.toml"), "readers.laser")
                    self.assert_left_out(reader, what + ", left out", 1, "record ")
                    self.assertEqual(reader["counts"]["in"], reader["counts"]["out"] + 1)
                    self.tearDown()
                    self.setUp()

    def test_trajectory(self):
        for column, value in ((0, "1000000000"), (0, "-5"), (0, "600000"), (0, "nan"), (1, "nan"), (1, "91"), (1, "-47.9"), (1, "48.5"),
                              (2, "190"), (2, "1e300"), (3, "1e9"), (3, "20000"), (4, "170"), (4, "1e300"), (6, "237"), (7, "1e9")):
            for row in (1, 1200, -2) if value == "1000000000" else (1200,):
                with self.subTest(column=column, value=value, row=row):
                    folder = self.copy()
                    edit_line(folder / "trajectory.csv", row, column, value)
                    report = self.run_timed(folder / "survey.toml")
                    tally = stage(report, "readers.trajectory")["tally"]
                    left_out = [k for k in tally if k.endswith("left out")]
                    self.assertEqual([tally[k]["count"] for k in left_out], [1], tally)
                    self.assertLess(stage(report, "report.truth")["findings"]["rms_3d"], 0.2)
                    self.tearDown()
                    self.setUp()

    def test_a_file_cut_behind_a_whole_line(self):
        folder = self.copy()
        lines = (folder / "laser.csv").read_text().split("\n")
        (folder / "laser.csv").write_text("\n".join(lines[:int(0.9 * len(lines))]) + "\n")
        reader = stage(self.run_ok(folder / "survey.toml"), "readers.laser")
        self.assert_left_out(reader, "lines whose records do not reach their stated begin or end: is a file cut?", 1, "line 2: .* at its end")


class WildNavigation(Wild):
    simulated = [o for o in TEXT if not o.startswith(("imu.file", "gnss.file", "output.trajectory"))] + ["output.trajectory=none"]

    def test_imu_and_gnss(self):
        for file, column, value in (("imu", 0, "1000000000"), ("imu", 0, "-5"), ("imu", 1, "1e9"), ("imu", 6, "1e300"), ("imu", 3, "3"),
                                    ("gnss", 0, "1000000000"), ("gnss", 0, "-5"), ("gnss", 4, "1e9"), ("gnss", 4, "1e300"),
                                    ("gnss", 4, "4112298")):
            with self.subTest(file=file, column=column, value=value):
                folder = self.copy()
                edit_line(folder / f"{file}.csv", 700, column, value)
                report = self.run_timed(folder / "survey.toml", config=FULL)
                tally = stage(report, f"readers.{file}")["tally"]
                self.assertEqual([v["count"] for k, v in tally.items() if k.endswith("left out")], [1], tally)
                self.assertLess(stage(report, "report.truth")["findings"]["rms_3d"], 0.5)
                self.tearDown()
                self.setUp()


class DateLine(Wild):
    def run_across(self, crs, geoid=False):
        folder = self.folder / "survey"
        done = swath("simulate", folder, "--quiet", *[w for o in SMALL + ["longitude=180 deg", "latitude=17 deg"] for w in ("--set", o)])
        self.assertEqual(done.returncode, 0, done.stderr)
        toml = folder / "survey.toml"
        text = toml.read_text()
        begin = text.index('crs = "')
        toml.write_text(text[:begin] + f'crs = "{crs}"' + text[text.index("\n", begin):])
        done = swath("run", CONFIG, "--survey", toml, "--output", self.out, "--quiet")
        if geoid and done.returncode != 0 and "grid" in done.stderr:
            self.skipTest("the geoid is not installed")
        self.assertEqual(done.returncode, 0, done.stderr)
        report = json.loads((self.out / "report.json").read_text())
        counts = stage(report, "georeference")["counts"]
        self.assertEqual(counts["in"], counts["out"])
        self.assertEqual(stage(report, "writers.las")["counts"]["out"], counts["out"])

    def test_a_survey_in_zone_60(self):
        self.run_across("EPSG:32660")

    def test_a_survey_in_zone_1(self):
        self.run_across("EPSG:32601")

    def test_a_survey_with_a_geoid(self):
        self.run_across("EPSG:32601+5773", geoid=True)


if __name__ == "__main__":
    unittest.main()
