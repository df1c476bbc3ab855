# SPDX-License-Identifier: GPL-3.0-or-later
"""bench/product_contents.py, by which a program's products are compared with another's: equal contents pass, every change of one is found."""
import json
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "bench"))
import product_contents as contents  # noqa: E402

REPORT = {"program": "swath 0.1.0", "seconds": 3.0, "stages": [{"type": "a.b", "fingerprint": "12", "seconds": 1.0, "findings": {"most_off_m": 0.5}},
                                                             {"type": "a.b", "seconds": 1.0, "findings": {"note": "three words here"}}]}
LINE = {"type": "Feature", "properties": {"height": 5}, "geometry": {"type": "LineString", "coordinates": [[10.0, 47.0], [10.1, 47.1]]}}
POINT = {"type": "Feature", "properties": {"height": 6}, "geometry": {"type": "Point", "coordinates": [10.2, 47.2]}}
POLYLINE = "0\nSECTION\n2\nENTITIES\n0\nPOLYLINE\n8\nindex\n70\n0\n" + "".join(
    f"0\nVERTEX\n8\nindex\n10\n{x}\n20\n{y}\n30\n5.0\n" for x, y in ((1.0, 2.0), (3.0, 4.0))) + "0\nSEQEND\n0\nENDSEC\n"
LIGHT = "0\nSECTION\n2\nENTITIES\n0\nLWPOLYLINE\n8\nindex\n90\n2\n70\n0\n38\n5.0\n10\n1.0\n20\n2.0\n10\n3.0\n20\n4.0\n0\nENDSEC\n"
MOSAIC = ('<VRTDataset rasterXSize="2" rasterYSize="1"><SRS>A</SRS><GeoTransform>0, 1, 0, 0, 0, -1</GeoTransform><VRTRasterBand dataType="Float32" band="1">'
          '<{kind}><SourceFilename relativeToVRT="1">{file}</SourceFilename><SourceBand>1</SourceBand><SrcRect xOff="0" yOff="0" xSize="2" ySize="1"/>'
          '<DstRect xOff="0" yOff="0" xSize="2" ySize="1"/></{kind}></VRTRasterBand></VRTDataset>')


class Contents(unittest.TestCase):
    def differences(self, name, old, new, table="", **keywords):
        with tempfile.TemporaryDirectory() as folder:
            files = [Path(folder) / side / name for side in ("old", "new")]
            for file, value in zip(files, (old, new)):
                file.parent.mkdir()
                file.write_bytes(value if isinstance(value, bytes) else (value if isinstance(value, str) else json.dumps(value)).encode())
            (Path(folder) / "table").write_text(table)
            if contents.kind_of(name) == "bytes":
                return [name] if contents.digest(files[0]) != contents.digest(files[1]) else []
            return contents.compare(name, *files, contents.Renamed(Path(folder) / "table"), **keywords)

    def changed(self, **findings):
        report = json.loads(json.dumps(REPORT))
        report["stages"][0]["findings"] = findings
        return report

    def test_a_report_by_value_and_key(self):
        later = {**REPORT, "program": "swath 0.2.0", "seconds": 4.0}
        self.assertEqual(self.differences("report.json", REPORT, later), [])
        self.assertEqual(len(self.differences("report.json", REPORT, self.changed(most_off_m=0.6))), 1)
        self.assertEqual(len(self.differences("report.json", REPORT, self.changed(max_off_m=0.5))), 2)
        for rule in ("most_off_m max_off_m", "report.json:stages/*/findings/most_off_m stages/*/findings/max_off_m # a word"):
            self.assertEqual(self.differences("report.json", REPORT, self.changed(max_off_m=0.5), rule), [], rule)
            self.assertEqual(len(self.differences("report.json", REPORT, self.changed(max_off_m=0.7), rule)), 1, rule)
        self.assertEqual(self.differences("report.json", REPORT, self.changed(most_off_m=0.5, n=1), "- n"), [])
        self.assertEqual(len(self.differences("report.json", REPORT, self.changed(most_off_m=0.5, n=1))), 1)

    def test_a_flag_is_no_number(self):
        self.assertEqual(len(self.differences("a.json", {"held": True}, {"held": 1})), 1)
        self.assertEqual(self.differences("a.json", {"n": 1}, {"n": 1.0}), [])

    def test_sentences(self):
        new = json.loads(json.dumps(REPORT).replace("three words", "other words"))
        self.assertEqual(len(self.differences("report.json", REPORT, new)), 1)
        self.assertEqual(self.differences("report.json", REPORT, new, sentences_may_differ=True), [])

    def test_features(self):
        old = {"features": [LINE, POINT]}
        self.assertEqual(self.differences("c.geojson", old, {"features": [POINT, LINE]}), [])
        for change in ({"features": [LINE]}, {"features": [LINE, {**POINT, "properties": {"height": 7}}]},
                       {"features": [LINE, {**POINT, "geometry": {"type": "Point", "coordinates": [10.2, 47.20000001]}}]}):
            self.assertTrue(self.differences("c.geojson", old, change), change)
        self.assertEqual(self.differences("c.dxf", POLYLINE, LIGHT.replace("38\n5.0\n", "38\n5.00001\n").replace("10\n1.0\n", "10\n1.00001\n")), [])
        for change in (POLYLINE.replace("\n3.0\n", "\n3.001\n"), POLYLINE.replace("index", "other"), LIGHT.replace("5.0", "6.0")):
            self.assertTrue(self.differences("c.dxf", POLYLINE, change), change)

    def test_tables(self):
        self.assertEqual(self.differences("t.csv", "a,b\n1,2.50\n", "b,a\n2.5,1\n"), [])
        self.assertEqual(self.differences("t.csv", "a,b\n1,2\n", "a,c\n1,2\n", "b c"), [])
        for change in ("a,b\n1,3\n", "a,b\n1,2\n1,2\n", "a\n1\n", "a,c\n1,2\n"):
            self.assertTrue(self.differences("t.csv", "a,b\n1,2\n", change), change)

    def test_mosaics(self):
        old = MOSAIC.format(kind="ComplexSource", file="a.tif")
        self.assertEqual(self.differences("m.vrt", old, MOSAIC.format(kind="SimpleSource", file="a.tif")), [])
        self.assertTrue(self.differences("m.vrt", old, MOSAIC.format(kind="ComplexSource", file="b.tif")))

    def test_points(self):
        las = bytearray(b"LASF" + bytes(300))
        other = bytearray(las)
        for at in (8, 26, 58, 90):
            other[at] = 1
        self.assertEqual(self.differences("p.laz", bytes(las), bytes(other)), [])
        for at in (4, 24, 94, 131, 303):
            self.assertTrue(self.differences("p.laz", bytes(las), bytes(las[:at]) + b"\x01" + bytes(las[at + 1:])), at)


if __name__ == "__main__":
    unittest.main()
