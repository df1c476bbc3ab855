# SPDX-License-Identifier: GPL-3.0-or-later
"""From IMU and GNSS records to the trajectory: its files read by another reader, its errors computed again, the main job on top of it."""
import bisect
import csv
import json
import math
import struct
import unittest
import xml.dom.minidom

from support import CONFIG, FULL, SMALLEST, SOURCE, Case, simulate, stage, swath

TRAJECTORY = SOURCE / "configs" / "trajectory.toml"
# Three lines with their turns, some four minutes; few shots.
FLIGHT = ["world.scene=hills", "world.length=300 m", "world.width=200 m", "flight.lines=2", "flight.cross_lines=1", "flight.height=300 m",
          "scanner.prf=2 kHz"]
ARC_SECOND = math.radians(1 / 3600)
SBET_FIELDS = ("time", "latitude", "longitude", "altitude", "vx", "vy", "vz", "roll", "pitch", "heading", "wander", "ax", "ay", "az", "wx", "wy",
               "wz")
SMRMSG_FIELDS = ("time", "north", "east", "down", "v_north", "v_east", "v_down", "roll", "pitch", "heading")
A, E2 = 6378137.0, 0.0066943799901413165  # WGS84


def records(file, fields):
    """Rows of little-endian doubles as {field: value}."""
    data = file.read_bytes()
    size = 8 * len(fields)
    assert len(data) % size == 0, file
    return [dict(zip(fields, row)) for row in struct.iter_unpack(f"<{len(fields)}d", data)]


def rows(file):
    with open(file, newline="") as text:
        return [{k: float(v) for k, v in row.items()} for row in csv.DictReader(text)]


def metres(latitude):
    """Metres per radian north and east at sea level."""
    w = 1 - E2 * math.sin(latitude) ** 2
    return A * (1 - E2) / w ** 1.5, A / math.sqrt(w) * math.cos(latitude)


def wrapped(angle):
    return math.remainder(angle, 2 * math.pi)


def differences(mine, truth):
    """Mine minus truth, north east down (m) and roll pitch heading (arc seconds), truth linear between its records."""
    times = [t["time"] for t in truth]
    out = []
    for m in mine:
        k = bisect.bisect_right(times, m["time"])
        if k == 0 or k == len(truth):
            continue
        a, b = truth[k - 1], truth[k]
        f = (m["time"] - a["time"]) / (b["time"] - a["time"])
        at = {n: a[n] + f * wrapped(b[n] - a[n]) for n in ("latitude", "longitude", "roll", "pitch", "heading")}
        north, east = metres(at["latitude"])
        height = a["altitude"] + f * (b["altitude"] - a["altitude"])
        scale = 1 + height / A
        out.append((north * scale * (m["latitude"] - at["latitude"]), east * scale * (m["longitude"] - at["longitude"]), height - m["altitude"],
                    *(wrapped(m[n] - at[n]) / ARC_SECOND for n in ("roll", "pitch", "heading"))))
    return out


class Navigation(Case):
    simulated = FLIGHT

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.made = cls.class_folder / "made"
        done = swath("run", TRAJECTORY, "--survey", cls.survey / "survey.toml", "--output", cls.made, "--quiet")
        assert done.returncode == 0, done.stderr
        cls.report = json.loads((cls.made / "report.json").read_text())
        cls.sbet = records(cls.made / "trajectory.sbet", SBET_FIELDS)

    def test_sbet_and_smrmsg_are_rows_of_doubles_in_seconds_of_week(self):
        smrmsg = records(self.made / "trajectory.smrmsg", SMRMSG_FIELDS)
        self.assertEqual(len(self.sbet), stage(self.report, "writers.trajectory")["findings"]["records"])
        self.assertEqual(len(self.sbet), len(smrmsg))
        self.assertEqual(stage(self.report, "writers.trajectory")["findings"]["sbet_gps_week"], 2317)
        for one, sigma in zip(self.sbet, smrmsg):
            self.assertEqual(one["time"], sigma["time"])
            self.assertTrue(all(0 < sigma[k] < 1 for k in SMRMSG_FIELDS[1:7]), sigma)
            self.assertTrue(all(0 < sigma[k] < 30 for k in SMRMSG_FIELDS[7:]), sigma)  # arc minutes
        steps = [b["time"] - a["time"] for a, b in zip(self.sbet, self.sbet[1:])]
        self.assertTrue(0.0049 < min(steps) and max(steps) < 0.0051, (min(steps), max(steps)))
        # Velocities north, west, up agree with the positions.
        a, b = self.sbet[1000], self.sbet[1100]
        north, east = metres(a["latitude"])
        scale, dt = 1 + a["altitude"] / A, b["time"] - a["time"]
        middle = self.sbet[1050]
        self.assertAlmostEqual(middle["vx"], north * scale * (b["latitude"] - a["latitude"]) / dt, delta=0.1)
        self.assertAlmostEqual(-middle["vy"], east * scale * (b["longitude"] - a["longitude"]) / dt, delta=0.1)
        self.assertAlmostEqual(middle["vz"], (b["altitude"] - a["altitude"]) / dt, delta=0.1)

    def test_the_report_tells_the_errors_that_another_reader_finds(self):
        errors = differences(self.sbet, records(self.survey / "truth" / "sbet.out", SBET_FIELDS))
        told = stage(self.report, "trajectory.ins_gnss")["findings"]["truth"]
        self.assertEqual(json.loads((self.made / "trajectory.json").read_text())["truth"], told)
        self.assertLessEqual(abs(len(errors) - told["all"]["compared"]), 2)
        # A straight line between true records 5 ms apart: 0.1 mm and 0.05 arc seconds beside the cubic.
        for k, (name, unit, delta) in enumerate((("north", "m", 1e-3), ("east", "m", 1e-3), ("down", "m", 1e-3), ("roll", "arcsec", 0.3),
                                                 ("pitch", "arcsec", 0.3), ("heading", "arcsec", 0.3))):
            one = told["all"][name]
            self.assertAlmostEqual(sum(e[k] for e in errors) / len(errors), one[f"mean_{unit}"], delta=delta, msg=name)
            self.assertAlmostEqual(math.sqrt(sum(e[k] ** 2 for e in errors) / len(errors)), one[f"rms_{unit}"], delta=delta, msg=name)
        for name in ("north", "east", "down"):
            self.assertLess(told["lines"][name]["rms_m"], 0.10)  # what GNSS fixes of 2.5 and 4.5 cm give in the worst of twenty flights
        self.assertLess(told["lines"]["compared"], told["all"]["compared"])

    def test_text_says_what_the_sbet_says(self):
        text = rows(self.made / "trajectory.csv")
        self.assertEqual(len(text), len(self.sbet))
        for one, other in zip(text[::97], self.sbet[::97]):
            self.assertEqual(one["gps_week"], 2317)
            self.assertAlmostEqual(one["gps_sow_s"], other["time"], delta=1e-6)
            self.assertAlmostEqual(math.radians(one["latitude_deg"]), other["latitude"], delta=1e-12)
            self.assertAlmostEqual(wrapped(math.radians(one["heading_deg"]) - other["heading"]), 0, delta=1e-10)
            self.assertAlmostEqual(one["v_east_mps"], -other["vy"], delta=1e-5)
        sigma = {round(r["time"], 4): r for r in records(self.made / "trajectory.smrmsg", SMRMSG_FIELDS)}
        nodes = rows(self.made / "trajectory_covariance.csv")
        self.assertGreater(len(nodes), 100)
        compared = 0
        for node in nodes[1:-1]:
            there = sigma.get(round(node["gps_sow_s"], 4))
            for name in ("north", "v_east", "heading"):
                self.assertGreater(node[f"{name}*{name}"], 0)
            for a, b in (("north", "east"), ("north", "v_north"), ("roll", "pitch")):
                self.assertLessEqual(abs(node[f"{a}*{b}"]), math.sqrt(node[f"{a}*{a}"] * node[f"{b}*{b}"]) * (1 + 1e-5))
            if there:
                compared += 1
                self.assertAlmostEqual(math.sqrt(node["north*north"]), there["north"], delta=1e-3 * there["north"])
                self.assertAlmostEqual(math.sqrt(node["v_down*v_down"]), there["v_down"], delta=1e-3 * there["v_down"])
                self.assertAlmostEqual(math.degrees(math.sqrt(node["heading*heading"])) * 60, there["heading"], delta=1e-3 * there["heading"])
        self.assertGreater(compared, 50)

    def test_plots_are_there_as_pictures_and_as_svg(self):
        names = {"track", "sigma", "separation", "separation_attitude", "innovations", "residuals", "attitude", "biases", "heading",
                 "errors_position", "errors_attitude"}
        for name in names:
            self.assertEqual((self.made / "plots" / f"{name}.png").read_bytes()[:8], b"\x89PNG\r\n\x1a\n")
            document = xml.dom.minidom.parse(str(self.made / "plots" / f"{name}.svg"))
            self.assertEqual(document.documentElement.tagName, "svg")
            self.assertGreater(len(document.getElementsByTagName("text")), 5)
        self.assertEqual({p.stem for p in (self.made / "plots").iterdir()}, names)
        self.run_ok(self.survey / "survey.toml", "--set", "ins_gnss.plots=[]", "--set", 'writers.trajectory.formats=["text"]', "--set",
                    "writers.trajectory.time=unix", "--set", "writers.trajectory.name=flight", config=TRAJECTORY)
        self.assertEqual({p.name for p in self.out.iterdir()}, {"report.json", "trajectory.json", "flight.csv"})
        self.assertEqual((self.out / "flight.csv").read_text().split(",")[0], "unix_s")

    def test_the_main_job_starts_from_the_records(self):
        report = self.run_ok(self.survey / "survey.toml", config=FULL)
        for name in ("trajectory.sbet", "trajectory.json", "plots/track.png", "relief.png", "points", "dtm.vrt"):
            self.assertTrue((self.out / name).exists(), name)
        self.assertEqual({s["type"] for s in report["stages"]} & {"readers.trajectory"}, set())
        found = stage(report, "report.truth")["findings"]
        self.assertLess(found["rms_3d"], 0.20)
        self.assertEqual(stage(report, "georeference")["counts"]["in"], stage(report, "georeference")["counts"]["out"])
        # The written SBET in place of the smoother: the same points, to what smrmsg and floats keep.
        survey = self.copy()
        text = (survey / "survey.toml").read_text()
        text = text.replace('"sbet.out"', f'"{self.made / "trajectory.sbet"}"').replace('"smrmsg.out"', f'"{self.made / "trajectory.smrmsg"}"')
        (survey / "survey.toml").write_text(text)
        again = stage(self.run_ok(survey / "survey.toml", config=CONFIG, out=self.folder / "given"), "report.truth")["findings"]
        self.assertAlmostEqual(again["rms_3d"], found["rms_3d"], delta=1e-5)
        for key in ("mean_east_m", "mean_north_m", "mean_up_m"):
            self.assertAlmostEqual(again["points"][key], found["points"][key], delta=1e-5)

    def test_events_on_one_time_scale_have_positions(self):
        survey = simulate(self.folder / "events", ["output.laser=false", "output.trajectory=none", "events.file=true",
                                                   "events.clock.before=1500 s"])
        out = self.folder / "placed"
        done = swath("run", SOURCE / "configs" / "events.toml", "--survey", survey / "survey.toml", "--output", out, "--quiet")
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(out / "events.csv", newline="") as text:
            placed = list(csv.DictReader(text))
        self.assertGreater(len(placed), 10)
        self.assertEqual({row["flags"] for row in placed}, {""})
        self.assertTrue((out / "leave_one_out.png").exists())

    def test_a_survey_without_records_of_the_sensors_is_refused(self):
        survey = simulate(self.folder / "short", SMALLEST) / "survey.toml"
        self.assert_bad_usage(survey, r"readers\.imu", r"\[\[imu\]\]", "readers.trajectory", config=FULL)
        text = (self.survey / "survey.toml").read_text()
        unstated = self.copy() / "survey.toml"
        unstated.write_text(text.replace('grade = "tactical"', 'gyro_bias = "1 deg/h"'))
        self.assert_bad_usage(unstated, "imu_spec.grade", config=TRAJECTORY)

    def test_a_geographic_crs_is_enough_without_a_map(self):
        survey = self.copy() / "survey.toml"
        survey.write_text(survey.read_text().replace("EPSG:32632", "EPSG:4326"))
        self.assert_bad_usage(survey, "not a map projection", config=FULL)
        self.run_ok(survey, "--set", "ins_gnss.plots=[]", config=TRAJECTORY)
        self.assertEqual((self.out / "trajectory.sbet").read_bytes(), (self.made / "trajectory.sbet").read_bytes())


if __name__ == "__main__":
    unittest.main()
