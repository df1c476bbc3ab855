# SPDX-License-Identifier: GPL-3.0-or-later
"""`swath qc`: a delivered cloud judged, with check points that are right, outside, few, of one name, in another CRS or height system."""
import json
import unittest
import xml.etree.ElementTree
from pathlib import Path

from support import CLOUD, SMALL, Case, simulate, stage, swath

MDQ = "{http://standards.iso.org/iso/19157/-2/mdq/1.0}"


class Quality(Case):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        survey = simulate(cls.class_folder / "survey", [*SMALL, "control.points=12"])
        done = swath("run", CLOUD.with_name("survey_sbet.toml"), "--survey", survey / "survey.toml", "--output", cls.class_folder / "made", "--quiet")
        assert done.returncode == 0, done.stderr
        cls.cloud = cls.class_folder / "made" / "points"
        cls.marks = (survey / "check.csv").read_text().splitlines()

    def rows(self, change=lambda cells: cells, count=None):
        """check.csv with the first rows, each changed as a list of cells."""
        file = self.folder / "marks.csv"
        head, rows = self.marks[0], self.marks[1:]
        file.write_text("\n".join([head, *(",".join(change(r.split(","))) for r in rows[:count])]) + "\n")
        return file

    def moved(self, column, by):
        at = self.marks[0].split(",").index(column)
        return self.rows(lambda cells: [f"{float(c) + by:.4f}" if k == at else c for k, c in enumerate(cells)])

    def judged(self, *more, code=0):
        done = swath("qc", self.cloud, "--output", self.out, "--quiet", *more)
        self.assertEqual(done.returncode, code, done.stderr)
        return json.loads((self.out / "report.json").read_text())

    def codes(self, *more):
        return [w["code"] for w in self.judged(*more)["warnings"]]

    def test_right_check_points(self):
        report = self.judged("--check", self.rows())
        self.assertEqual([w["code"] for w in report["warnings"]], [])
        found = stage(report, "quality.points")["findings"]
        self.assertEqual(found["marks"], 12)
        self.assertLess(found["nva_m"], 0.2)
        self.assertEqual(stage(report, "report.quality")["findings"]["requirements"], [])
        tree = xml.etree.ElementTree.parse(self.out / "quality.xml").getroot()
        self.assertEqual(tree.tag, MDQ + "DQ_DataQuality")
        reports = tree.findall(MDQ + "report")
        self.assertGreaterEqual(len(reports), 6)
        self.assertEqual(list(tree.iter(MDQ + "DQ_ConformanceResult")), [])
        self.assertTrue((self.out / "quality.pdf").read_bytes().startswith(b"%PDF-1.4"))
        self.assertIn("Check points", (self.out / "quality.html").read_text())

    def test_a_level_that_is_missed_is_code_3(self):
        report = self.judged("--level", "QL0", code=3)  # some 0.7 pulses per m2
        self.assertGreaterEqual(stage(report, "report.quality")["findings"]["missed"], 2)
        tree = xml.etree.ElementTree.parse(self.out / "quality.xml").getroot()
        verdicts = [e.find(".//{*}Boolean").text for e in tree.iter(MDQ + "DQ_ConformanceResult")]
        self.assertIn("false", verdicts)

    def test_check_points_that_do_not_fit_are_named(self):
        self.assertEqual(self.codes("--check", self.moved("x", 20000)), ["check.outside", "check.few"])
        few = self.judged("--check", self.rows(count=2))
        self.assertEqual([w["code"] for w in few["warnings"]], ["check.few"])
        self.assertNotIn("nva_m", stage(few, "quality.points")["findings"])
        self.assertEqual(self.codes("--check", self.rows(lambda cells: ["same", *cells[1:]])), ["check.names"])
        self.assertEqual(self.codes("--check", self.moved("z", -46.8)), ["check.heights"])
        # Places of zone 33 in zone 32 lie far off, those of zone 32 that say so do not.
        self.assertEqual(self.codes("--check", self.rows(), "--check-crs", "EPSG:32633"), ["check.outside", "check.few"])

    def test_check_points_without_a_header(self):
        names = self.marks[0].split(",")
        name, x, y, z = (names.index(k) for k in ("name", "x", "y", "z"))
        file = self.folder / "pnezd.csv"
        rows = [r.split(",") for r in self.marks[1:]]
        file.write_text("".join(f"{r[name]},{r[y]},{r[x]},{r[z]},MON\n" for r in rows))
        self.assertEqual(self.codes("--check", file), [])
        said = swath("qc", self.cloud, "--output", self.folder / "said", "--check", file)
        self.assertRegex(said.stdout, r"pnezd\.csv has no header: column 3 is taken as easting, 2 as northing, 4 as height, 1 as name: so 12 of 12 points lie")
        table = stage(self.judged("--check", file), "quality.points")["findings"]["files"]
        self.assertEqual([{k: t[k] for k in ("name", "x", "y", "z")} for t in table], [{"name": "1", "x": "3", "y": "2", "z": "4"}])
        self.assertEqual(Path(table[0]["file"]).name, "pnezd.csv")
        self.assertEqual(self.codes("--check", file, "--check-columns", "1,3,2,4"), [])
        self.assertIn("check.outside", self.codes("--check", file, "--check-columns", "1,2,3,4"))

    def test_an_empty_height_costs_its_point_alone(self):
        z = self.marks[0].split(",").index("z")
        first = self.marks[1].split(",")[0]
        report = self.judged("--check", self.rows(lambda cells: [*cells[:z], "", *cells[z + 1:]] if cells[0] == first else cells))
        self.assertEqual(stage(report, "quality.points")["findings"]["marks"], 11)
        done = swath("qc", self.cloud, "--output", self.folder / "no", "--quiet", "--check", self.rows(lambda cells: [*cells[:z], "", *cells[z + 1:]]))
        self.assert_error(done, 1, "a coordinate is empty or not finite", r"hint: check the columns \(--check-columns\) and the CRS \(--check-crs\)")

    def test_the_hint_of_check_points_far_away(self):
        warning = self.judged("--check", self.moved("x", 20000))["warnings"][0]["text"]
        self.assertRegex(warning, r"none of the 12 check points lies within the survey, the nearest is (19|20)\.\d km away.*CRS")

    def test_wrong_requests(self):
        for more, words in ((["--level", "QL7"], ["QL7", "QL2"]), (["--reference", "none.tif"], ["none.tif"]), (["--check", "none.csv"], ["none.csv"]),
                            (["--crs", "EPSG:1"], ["EPSG:1"]), (["--check-crs", "EPSG:32633"], ["--check-crs", "--check FILE"]),
                            (["--check-columns", "1,2,3,4"], ["--check-columns", "--check FILE"])):
            with self.subTest(more=more):
                self.assert_error(swath("qc", self.cloud, "--output", self.out, "--quiet", *more), 2, *words)
                self.assertFalse(self.out.exists())
        (self.folder / "empty").mkdir()
        self.assert_error(swath("qc", self.folder / "empty", "--output", self.out), 2, "empty")


if __name__ == "__main__":
    unittest.main()
