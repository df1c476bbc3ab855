# SPDX-License-Identifier: GPL-3.0-or-later
"""A calibration flight as its user meets it: configs/calibrate.toml, good flights and bad."""
import ast
import json
import re
import struct
import unittest

from support import SOURCE, Case, stage, swath

CONFIG = SOURCE / "configs" / "calibrate.toml"
# A small flight: lines to and fro and across over halls, at one height.
FLIGHT = ["flight.pattern=calibration", "world.scene=airfield", "world.length=360 m", "world.width=360 m", "flight.line_length=420 m",
          "flight.height=350 m", "flight.second_height=0 m", "flight.profile_lines=false", "scanner.prf=15 kHz", "output.trajectory=none",
          "output.truth_returns=false"]
QUICK = ["--set", "ins_gnss.plots=[]", "--set", "adjust.planes.planes=300", "--set", "adjust.jackknife.blocks=5"]


def change_column(source, target, name, change):
    """A copy of a structured .npy file with one column of doubles changed."""
    data = bytearray(source.read_bytes())
    header = 10 + struct.unpack_from("<H", data, 8)[0]
    row, at = 0, None
    for field, kind in ast.literal_eval(data[10:header].decode())["descr"]:
        if field == name:
            at = row
        row += int(kind[2:])
    for offset in range(header + at, len(data), row):
        struct.pack_into("<d", data, offset, change(struct.unpack_from("<d", data, offset)[0]))
    target.write_bytes(data)


def degrees(text):
    return float(text.removesuffix(" deg"))


class Calibrated(Case):
    simulated = FLIGHT

    def test_the_boresight_is_found_and_the_survey_takes_it(self):
        report = self.run_ok(self.survey / "survey.toml", *QUICK, config=CONFIG)
        found = json.loads((self.out / "calibration.json").read_text())
        truth = json.loads((self.survey / "truth" / "calibration.json").read_text())
        for key, most in (("roll", 0.01), ("pitch", 0.01), ("heading", 0.03)):  # deg; a small flight
            error = abs(degrees(found["calibration"][key]) - degrees(truth[key]))
            self.assertLess(error, most, key)
            self.assertLess(error, 4 * degrees(found["sigma"][key]), key)
        self.assertTrue(found["verdict"].startswith("Calibrated"), found["verdict"])
        self.assertIn(found["verdict"], (self.out / "report.html").read_text())
        self.assertTrue(stage(report, "calib.flat_target")["findings"]["done"])
        self.assertTrue(list((self.out / "differences").glob("*_after.tif")))
        # The second act: a survey that names the file has its values.
        survey = (self.survey / "survey.toml").read_text()
        (self.survey / "calibrated.toml").write_text(re.sub(r"(?m)^crs = ", f'calibration_file = "{self.out}/calibration.json"\ncrs = ', survey, count=1))
        done = swath("check", SOURCE / "configs" / "survey.toml", "--survey", self.survey / "calibrated.toml")
        self.assertEqual(done.returncode, 0, done.stderr)


class Refused(Case):
    simulated = FLIGHT

    def edited(self, change):
        text = (self.survey / "survey.toml").read_text()
        new = change(text)
        self.assertNotEqual(new, text)
        (self.survey / "edited.toml").write_text(new)
        return self.survey / "edited.toml"

    def refuse(self, survey, *words):
        config = self.folder / "adjust.toml"
        config.write_text(CONFIG.read_text().replace('[[stage]]\ntype = "calib.flat_target"\n', ""))
        done = swath("run", config, "--survey", survey, "--output", self.out, "--quiet", *QUICK)
        self.assert_error(done, 1, *words, "hint: ")

    def test_a_scan_angle_of_the_wrong_sign_is_noticed(self):
        change_column(self.survey / "laser.npy", self.survey / "turned.npy", "scan_angle_deg", lambda a: -a)
        self.refuse(self.edited(lambda t: t.replace('"laser.npy"', '"turned.npy"')), "sign of the scan angle")

    def test_constant_ranges_are_noticed(self):
        change_column(self.survey / "laser.npy", self.survey / "constant.npy", "range", lambda r: 400.0)
        self.refuse(self.edited(lambda t: t.replace('"laser.npy"', '"constant.npy"')), "the ranges are constant")

    def test_control_of_another_datum_is_noticed(self):
        lines = (self.survey / "control.csv").read_text().splitlines()
        head = lines[0].split(",")
        at = head.index("z")
        shifted = [lines[0]]
        for line in lines[1:]:
            fields = line.split(",")
            fields[at] = str(float(fields[at]) + 2.5)
            shifted.append(",".join(fields))
        (self.survey / "shifted.csv").write_text("\n".join(shifted) + "\n")
        survey = self.edited(lambda t: t.replace('"control.csv"', '"shifted.csv"'))
        config = self.folder / "adjust.toml"
        config.write_text(CONFIG.read_text().replace('[[stage]]\ntype = "calib.flat_target"\n', ""))
        report = self.run_ok(survey, *QUICK, config=config)
        told = " ".join(stage(report, "calib.adjust")["findings"]["findings"])
        self.assertIn("datum", told)


if __name__ == "__main__":
    unittest.main()
