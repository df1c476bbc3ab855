# SPDX-License-Identifier: GPL-3.0-or-later
"""Records that are damaged: one clear error that names the place, and nothing left behind."""
import json
import os
import shutil
import struct
import unittest

from support import CONFIG, INFINITE, NAN, SMALLEST, Case, Npy, edit_line, f8, patch, stage, substitute, swath, truncate


def edit_every(source, file, column, value, every=20):
    """Sets a field of every so many lines: more than a slip."""
    lines = source.read_text().split("\n")
    for number in range(every, len(lines) - 1, every):
        fields = lines[number].split(",")
        fields[column] = value
        lines[number] = ",".join(fields)
    file.write_text("\n".join(lines))


class Arrays(Case):
    simulated = SMALLEST

    def setUp(self):
        super().setUp()
        self.toml = self.copy() / "survey.toml"
        self.file = self.toml.parent / "laser.npy"
        self.npy = Npy(self.file)

    def test_truncated(self):
        size = os.path.getsize(self.file)
        for rest in (size // 2, size - 1, self.npy.begin, 40, 8, 3, 0):
            with self.subTest(bytes=rest):
                truncate(self.file, rest)
                self.assert_bad_data(self.toml, r"laser\.npy: byte \d+: ")

    def test_wrong_magic(self):
        patch(self.file, 0, b"XXXXXX")
        self.assert_bad_data(self.toml, r"laser\.npy: byte 0: .*does not begin with")

    def test_counts_that_lie(self):
        digits = len(str(self.npy.rows))
        for rows in (self.npy.rows + 1000, self.npy.rows - 1000, int("9" * digits)):
            with self.subTest(rows=rows):
                patch(self.file, self.npy.rows_at, str(rows).zfill(digits).encode())
                self.assert_bad_data(self.toml, r"laser\.npy: byte \d+: .*rows")

    def test_numbers_that_are_none(self):
        for field, word in (("time", "time"), ("angle", "scan angle"), ("range", "range")):
            for value in (NAN, INFINITE, -INFINITE):
                with self.subTest(field=field, value=value):
                    shutil.copy(self.survey / "laser.npy", self.file)
                    for row in range(0, self.npy.rows, 20):  # more than a slip
                        self.npy.set(row, field, value)
                    self.assert_bad_data(self.toml, rf"laser\.npy: record \d+: the {word} is missing or not finite")

    def test_time_that_goes_back(self):
        with open(self.file, "rb") as f:
            f.seek(self.npy.begin + 50 * self.npy.ROW)
            earlier = f.read(8)
        patch(self.file, self.npy.begin + 100 * self.npy.ROW, earlier)
        self.assert_bad_data(self.toml, r"laser\.npy: record 100: time goes back by .* inside line 1")

    def test_ranges_that_cannot_be_are_left_out_and_counted(self):
        self.npy.set(100, "range", -5.0)
        self.npy.set(200, "range", 1e30)
        reader = stage(self.run_ok(self.toml), "readers.laser")
        self.assertEqual(reader["tally"]["records with a range not positive, left out"], {"count": 1, "examples": ["record 100"]})
        self.assertEqual(reader["tally"]["records with a range over 100 km, left out"], {"count": 1, "examples": ["record 200"]})
        self.assertEqual(reader["counts"], {"in": self.npy.rows, "out": self.npy.rows - 2})

    def test_missing_column(self):
        substitute(self.toml, 'range = "range"', 'range = "rnge"')
        self.assert_bad_usage(self.toml, r"survey\.toml:\d+:\d+: laser\[1\]\.columns\.range: .*laser\.npy: no field 'rnge'", "did you mean 'range'")

    def test_missing_file(self):
        os.remove(self.file)
        self.assert_bad_usage(self.toml, r"survey\.toml:\d+:\d+: laser\[1\]\.file: no such file")


class Text(Case):
    simulated = SMALLEST + ['output.formats=["csv"]', "output.trajectory=text"]

    def setUp(self):
        super().setUp()
        self.toml = self.copy() / "survey.toml"
        self.laser = self.toml.parent / "laser.csv"
        self.trajectory = self.toml.parent / "trajectory.csv"

    def test_good(self):
        self.run_ok(self.toml)

    def test_missing_column(self):
        substitute(self.toml, '"range_m"', '"rnge_m"')
        self.assert_bad_usage(self.toml, r"survey\.toml:\d+:\d+: laser\[1\]\.columns\.range: .*laser\.csv: no column 'rnge_m'", "did you mean 'range_m'")
        substitute(self.toml, '"rnge_m"', '"range_m"')
        substitute(self.toml, '"roll_deg"', '"rol_deg"')
        self.assert_bad_usage(self.toml, r"survey\.toml:\d+:\d+: trajectory\[1\]\.columns\.roll: .*trajectory\.csv: no column 'rol_deg'", "did you mean 'roll_deg'")

    def test_cut_line(self):
        lines = self.laser.read_text().split("\n")
        lines[100] = lines[100][:20]
        self.laser.write_text("\n".join(lines))
        self.assert_bad_data(self.toml, r"laser\.csv:101: the line has \d fields")

    def test_no_number(self):
        edit_line(self.laser, 100, 3, "abc")
        self.assert_bad_data(self.toml, r"laser\.csv:101: 'abc' in column 'range_m' is no number")

    def test_numbers_that_are_none(self):
        for column, value in ((0, "nan"), (0, "inf"), (2, "nan"), (3, "-inf"), (3, "")):
            with self.subTest(column=column, value=value):
                edit_every(self.survey / "laser.csv", self.laser, column, value)
                self.assert_bad_data(self.toml, r"laser\.csv: record \d+: .* is missing or not finite")
        shutil.copy(self.survey / "laser.csv", self.laser)
        edit_every(self.survey / "trajectory.csv", self.trajectory, 3, "nan")
        self.assert_bad_data(self.toml, r"trajectory\.csv: record 19: height is not finite")

    def test_time_that_goes_back(self):
        lines = self.laser.read_text().split("\n")
        edit_line(self.laser, 100, 0, lines[50].split(",")[0])
        self.assert_bad_data(self.toml, r"laser\.csv: record 99: time goes back")
        shutil.copy(self.survey / "laser.csv", self.laser)
        edit_line(self.trajectory, 100, 0, "474000")
        self.assert_bad_data(self.toml, r"trajectory\.csv: record \d+: time goes back")

    def test_no_records(self):
        self.laser.write_text(self.laser.read_text().split("\n")[0] + "\n")
        self.assert_bad_data(self.toml, r"laser\.csv: no line of numbers")
        self.laser.write_text("")
        self.assert_bad_data(self.toml, r"laser\.csv")


class LasRecords(Case):
    """Records in the scanner's frame, as LAS and as LAZ."""
    simulated = SMALLEST + ['output.formats=["las", "laz"]']

    def setUp(self):
        super().setUp()
        folder = self.copy()
        self.cases = [(folder / "survey.toml", folder / "laser.las"), (folder / "survey_laz.toml", folder / "laser.laz")]

    def restore(self, file):
        shutil.copy(self.survey / file.name, file)

    def test_good(self):
        for toml, file in self.cases:
            self.run_ok(toml, out=self.folder / file.suffix)

    def test_truncated(self):
        for toml, file in self.cases:
            size = os.path.getsize(file)
            for rest in (size - 1, size // 2, 400, 100, 2, 0):
                with self.subTest(file=file.name, bytes=rest):
                    truncate(file, rest)
                    self.assert_bad_data(toml, file.name.replace(".", r"\."), "byte")

    def test_wrong_magic(self):
        for toml, file in self.cases:
            patch(file, 0, b"LASX")
            self.assert_bad_data(toml, file.name + ": byte 0: not a LAS file")

    def test_counts_that_lie(self):
        for toml, file in self.cases:
            for count in (10**6, 1 << 60, 1000):
                with self.subTest(file=file.name, count=count):
                    patch(file, 247, struct.pack("<Q", count))
                    self.assert_bad_data(toml, file.name, "byte", "points")

    def test_numbers_that_are_none(self):
        for toml, file in self.cases:
            for at, value in ((131, NAN), (131, INFINITE), (139, 0.0), (155, NAN)):
                with self.subTest(file=file.name, at=at, value=value):
                    self.restore(file)
                    patch(file, at, f8(value))
                    self.assert_bad_data(toml, file.name, "byte")
        toml, file = self.cases[0]
        self.restore(file)
        data = file.read_bytes()
        begin, length = struct.unpack_from("<I", data, 96)[0], struct.unpack_from("<H", data, 105)[0]
        for record in range(0, (len(data) - begin) // length, 20):
            patch(file, begin + record * length + 22, f8(NAN))
        self.assert_bad_data(toml, r"laser\.las: record 0: the time is missing or not finite")

    def test_damaged_in_the_middle(self):
        # A coder's bytes bear no check sums: what is decoded is nonsense, and is refused by what it says.
        toml, file = self.cases[1]
        patch(file, os.path.getsize(file) // 2, b"\xff" * 2000)
        self.assert_error(swath("run", CONFIG, "--survey", toml, "--output", self.out, "--quiet"), 1, "hint: ")
        # Where only a late stage notices, the products before it stay; none of its own and no report of a run that did not end.
        self.assertFalse((self.out / "report.json").exists())
        self.assertFalse((self.out / "points").exists())


class Trajectories(Case):
    simulated = SMALLEST

    def setUp(self):
        super().setUp()
        self.toml = self.copy() / "survey.toml"
        self.sbet = self.toml.parent / "sbet.out"

    def test_truncated(self):
        for rest in (-50, 136 * 3 + 1, 135, 0):
            with self.subTest(bytes=rest):
                truncate(self.sbet, rest)
                self.assert_bad_data(self.toml, r"sbet\.out: ")
        shutil.copy(self.survey / "sbet.out", self.sbet)
        truncate(self.toml.parent / "smrmsg.out", -11)
        self.assert_bad_data(self.toml, r"smrmsg\.out: byte \d+: .*no whole number of smrmsg records")

    def test_another_format(self):
        shutil.copy(self.toml.parent / "laser.npy", self.sbet)
        truncate(self.sbet, os.path.getsize(self.sbet) // 136 * 136)
        self.assert_bad_data(self.toml, r"sbet\.out: record 0: ")

    def test_numbers_that_are_none(self):
        for field in (0, 1, 2, 3, 7, 8, 9):
            for value in (NAN, INFINITE):
                with self.subTest(field=field, value=value):
                    shutil.copy(self.survey / "sbet.out", self.sbet)
                    for record in range(0, os.path.getsize(self.sbet) // 136, 20):
                        patch(self.sbet, 136 * record + 8 * field, f8(value))
                    self.assert_bad_data(self.toml, r"sbet\.out: record 0: .*(not|no)")
        shutil.copy(self.survey / "sbet.out", self.sbet)
        patch(self.toml.parent / "smrmsg.out", 80 * 100 + 8, f8(NAN))
        reader = stage(self.run_ok(self.toml, out=self.folder / "one"), "readers.trajectory")
        self.assertEqual(reader["tally"]["smrmsg records with a sigma that is negative or not finite, left out"]["count"], 1)
        for record in range(0, os.path.getsize(self.toml.parent / "smrmsg.out") // 80, 20):
            patch(self.toml.parent / "smrmsg.out", 80 * record + 8, f8(NAN))
        self.assert_bad_data(self.toml, r"smrmsg\.out: record 0: ")

    def test_time_that_goes_back(self):
        patch(self.sbet, 136 * 100, self.sbet.read_bytes()[:8])
        self.assert_bad_data(self.toml, r"sbet\.out: record 100: time goes back by ")

    def test_degrees_in_place_of_radians(self):
        data = bytearray(self.sbet.read_bytes())
        for at in range(0, len(data), 136):
            struct.pack_into("<2d", data, at + 8, 47.9, 10.5)
        self.sbet.write_bytes(data)
        self.assert_bad_data(self.toml, r"sbet\.out: record 0: .*radians")

    def test_no_return_covered(self):
        substitute(self.toml, "week = 2317\n\n[line_time]", "week = 2318\n\n[line_time]")
        self.assert_bad_data(self.toml, "the trajectory covers no laser record", "1 week apart")

    def test_returns_that_are_not_covered_are_left_out_and_counted(self):
        whole = stage(self.run_ok(self.toml, out=self.folder / "whole"), "georeference")["counts"]["in"]
        # The line begins 5 s after the trajectory, at 200 records a second, and lasts 1.2 s.
        for name, size in (("sbet.out", 136), ("smrmsg.out", 80)):
            truncate(self.toml.parent / name, size * (5 * 200 + 120) // size * size)
        done = swath("run", CONFIG, "--survey", self.toml, "--output", self.out)
        self.assertRegex(done.stdout, r"warning \[laser\.outside_trajectory\]: \d+ of \d+ returns lie outside the trajectory or in its gaps "
                         r"\([\d.]+ %\) and are left out: [\w.]+: \d+ from \d{4}-\d\d-\d\dT[\d:.]+Z to ")
        one = stage(json.loads((self.out / "report.json").read_text()), "georeference")
        files = one["tally"]["outside the trajectory, left out"]["files"]
        left_out = one["tally"]["outside the trajectory, left out"]["count"]
        self.assertEqual(sum(f["count"] for f in files), left_out)
        self.assertLess(files[0]["first_s"], files[0]["last_s"])
        self.assertEqual(one["counts"], {"in": whole, "out": whole - left_out})
        self.assertGreater(left_out, 0.2 * whole)
        self.assertLess(left_out, 0.8 * whole)


def made_csd(pulses=1500):
    """A line flown due north at 60 m/s, 800 m above a plane, scanned to and fro by 0.05 rad: points 3 to 4 m apart."""
    head = bytearray(2048)
    head[0:23] = b"CSD\0Optech Incorporated"
    struct.pack_into("<HH", head, 104, 2048, 1660)
    struct.pack_into("<I", head, 124, pulses)
    out = bytes(head)
    for i in range(pulses):
        angle = 0.05 * (abs((i % 60) - 30) / 15 - 1)
        slant = 800 / (1 - angle**2 / 2 + angle**4 / 24)
        out += struct.pack("<dB4f4H4f2df", 100 + 0.001 * i, 1, slant, 0, 0, 0, 90, 0, 0, 0, angle, 0, 0, 0, 0.6 + 0.06 * i / 6.37e6, -1.5,
                           1000)
    return out


class Csd(Case):
    TOML = '''crs = "EPSG:32616"
calibration_file = "a.csd"
[[laser]]
file = "a.csd"
[[trajectory]]
file = "a.csd"
'''

    def setUp(self):
        super().setUp()
        self.file = self.folder / "a.csd"
        self.file.write_bytes(made_csd())
        self.toml = self.folder / "survey.toml"
        self.toml.write_text(self.TOML)

    def test_good(self):
        report = self.run_ok(self.toml)
        self.assertEqual(stage(report, "writers.las")["counts"]["out"], 1500)

    def test_truncated(self):
        for rest in (-1, -69, 2048 + 69 * 10 + 5, 1000, 2, 0):
            with self.subTest(bytes=rest):
                truncate(self.file, rest)
                self.assert_bad_data(self.toml, r"a\.csd: byte \d+: ")

    def test_wrong_magic(self):
        patch(self.file, 0, b"DSC\0")
        self.assert_bad_data(self.toml, r"a\.csd: byte 0: ")

    def test_counts_that_lie(self):
        for count in (1501, 1499, 0xFFFFFFFF):
            with self.subTest(count=count):
                patch(self.file, 124, struct.pack("<I", count))
                self.assert_bad_data(self.toml, r"a\.csd: byte \d+: ", "pulses")

    def test_numbers_that_are_none(self):
        poses, shots = ((0, "<d"), (37, "<f"), (49, "<d"), (65, "<f")), ((9, "<f"), (33, "<f"))
        for at, form in poses + shots:
            for value in (NAN, INFINITE):
                with self.subTest(at=at, value=value):
                    self.file.write_bytes(made_csd())
                    patch(self.file, 2048 + 69 * 100 + at, struct.pack(form, value))
                    if (at, form) in poses:
                        self.assert_bad_data(self.toml, r"a\.csd: record 100: .* not finite")
                        continue
                    shutil.rmtree(self.out, ignore_errors=True)
                    report = self.run_ok(self.toml)
                    self.assertLess(stage(report, "writers.las")["counts"]["out"], 1500)
                    self.assertRegex(str(stage(report, "readers.laser")["tally"]), r"record 100")

    def test_more_returns_than_a_pulse_holds(self):
        patch(self.file, 2048 + 69 * 100 + 8, b"\x09")
        self.assert_bad_data(self.toml, r"a\.csd: record 100: .*9 returns")

    def test_time_that_goes_back(self):
        patch(self.file, 2048 + 69 * 100, f8(100.0))
        self.assert_bad_data(self.toml, r"a\.csd: record 100: time goes back")


if __name__ == "__main__":
    unittest.main()
