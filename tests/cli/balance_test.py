# SPDX-License-Identifier: GPL-3.0-or-later
"""Every record of a file is handed on or left out for a stated reason, from the file's own count on."""
import re
import unittest

from support import CLOUD, SMALL, SOURCE, Case, Npy, cloud_survey, stage


class Balance(Case):
    simulated = [*SMALL, "flight.lines=3"]

    def assert_balance(self, reader, kind, rows):
        [records] = reader["records"]
        self.assertEqual((records["name"], records["read"]), (kind, rows))
        self.assertEqual(reader["counts"], {"in": rows, "out": records["kept"]})
        reasons = {k: v["count"] for k, v in reader.get("tally", {}).items() if k.startswith(kind + " ") and k.endswith("left out")}
        self.assertEqual(rows, records["kept"] + records["left_out"])
        self.assertEqual(records["left_out"], sum(reasons.values()))
        return reasons

    def test_two_of_three_lines_removed(self):
        toml = self.copy() / "survey.toml"
        npy = Npy(toml.parent / "laser.npy")
        npy.set(100, "range", -5.0)
        text = toml.read_text()
        begin, second = [m.start() for m in re.finditer(r"(?m)^\[\[line\]\]", text)][:2]
        rest = re.split(r"(?m)^(?=\[(?!\[line\]\]))", text[begin:], maxsplit=1)
        toml.write_text(text[:second] + (rest[1] if len(rest) > 1 else ""))
        reader = stage(self.run_ok(toml, config=SOURCE / "configs" / "georeference.toml"), "readers.laser")
        reasons = self.assert_balance(reader, "records", npy.rows)
        self.assertEqual(set(reasons), {"records outside every line, left out", "records with a range not positive, left out"})
        self.assertGreater(reasons["records outside every line, left out"], npy.rows // 2)

    def test_a_cloud_beyond_its_area(self):
        points = [(500000 + x, 5300000 + y, 400.0) for x in range(40) for y in range(40)]
        toml = cloud_survey(self.folder / "cloud", [*points, (900000, 5300000, 400.0)])
        toml.write_text(toml.read_text() + "\n[area]\neast = 500029.5\n")
        reader = stage(self.run_ok(toml, config=CLOUD), "readers.las")
        reasons = self.assert_balance(reader, "points", 1601)
        self.assertEqual(sum(reasons.values()), 401)


if __name__ == "__main__":
    unittest.main()
