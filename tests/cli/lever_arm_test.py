# SPDX-License-Identifier: GPL-3.0-or-later
"""Lever arms from a hangar survey: a hangar made here, what its instrument reads, and the vectors that must come out."""
import json
import math
import random
import tomllib
import unittest

from support import CONFIG, SOURCE, Case, substitute

LEVER_ARM = SOURCE / "configs" / "lever_arm.toml"
STATIONS = {"S1": (5.2, 1.6, 1.62), "S2": (12.9, 2.2, 1.55), "S3": (14.1, 9.3, 1.81), "S4": (4.4, 10.2, 1.47)}
# The aircraft stands level, its nose 30 deg to the right of the hangar's y. Points forward, right, down from the IMU.
HEADING = math.radians(30)
IMU = (8.5, 6.0, 1.1)
POINTS = {"imu": (0, 0, 0), "scanner": (0.4, -0.1, 0.35), "antenna": (-0.75, 0.2, -1.1), "fore": (3.1, 0, 0.1), "aft": (-4.2, 0, -0.3)}
# Sigmas of the made survey's lever arms are 1 to 4 mm; nothing may be off by more than five of them.
FARTHEST_OFF = 0.02


def in_hangar(body):
    x, y = body[0] * math.sin(HEADING) + body[1] * math.cos(HEADING), body[0] * math.cos(HEADING) - body[1] * math.sin(HEADING)
    return IMU[0] + x, IMU[1] + y, IMU[2] - body[2]


def level_angle(a, b):
    return math.atan2(b[0] - a[0], b[1] - a[1])


def make_hangar(folder):
    """hangar.toml with tables of targets and distances beside it."""
    noise = random.Random(1)
    targets = {f"T{k + 1}": (17.0 * (k % 12) / 11, 12.0 * (k // 12), 0.4 + 2.4 * ((0.618 * k) % 1)) for k in range(24)}
    points = {name: in_hangar(body) for name, body in POINTS.items()}
    distances = ["from,to,distance"]
    angles, verticals = ["at,from,to,angle"], ["at,to,angle"]
    second = math.radians(5 / 3600)
    for s, a in STATIONS.items():
        for to, b in [*list(targets.items())[::2], *points.items()]:
            d = math.dist(a, b)
            distances.append(f"{s},{to},{d + noise.gauss(0, 0.002 + 2e-6 * d):.4f}")
        for to, b in points.items():
            up = math.atan2(b[2] - a[2], math.dist(a[:2], b[:2])) + noise.gauss(0, second)
            verticals.append(f"{s},{to},{math.degrees(up):.6f}")
            for other, c in STATIONS.items():
                if other != s:
                    angle = abs(math.remainder(level_angle(a, b) - level_angle(a, c), 2 * math.pi)) + noise.gauss(0, second)
                    angles.append(f"{s},{other},{to},{math.degrees(angle):.6f}")
    (folder / "distances.csv").write_text("\n".join(distances) + "\n")
    (folder / "angles.csv").write_text("\n".join(angles) + "\n")
    (folder / "verticals.csv").write_text("\n".join(verticals) + "\n")
    (folder / "targets.csv").write_text("name,x,y,z\n" + "".join(f"{n},{x},{y},{z}\n" for n, (x, y, z) in targets.items()))
    stations = "".join(f'[[station]]\nname = "{s}"\n\n' for s in STATIONS)
    roles = "".join(f'[[point]]\nname = "{p}"\nrole = "{p}"\n\n' for p in points)
    (folder / "hangar.toml").write_text(
        'targets_file = "targets.csv"\ndistances_file = "distances.csv"\nangles_file = "angles.csv"\nverticals_file = "verticals.csv"\n'
        f'angle_unit = "deg"\n\n{stations}{roles}[axes]\nroll_sigma = "0.05 deg"\npitch_sigma = "0.05 deg"\nheading_sigma = "0.05 deg"\n')
    (folder / "survey.toml").write_text('name = "hangar"\nhangar = "hangar.toml"\n')
    return folder / "survey.toml"


class LeverArm(Case):
    def setUp(self):
        super().setUp()
        self.hangar = make_hangar(self.folder)

    def test_the_config_gives_what_survey_toml_takes(self):
        report = self.run_ok(self.hangar, config=LEVER_ARM)
        told = json.loads((self.out / "lever_arm.json").read_text())
        self.assertEqual(next(s for s in report["stages"] if s["type"] == "calib.lever_arm")["findings"], told)
        arms = {(a["from"], a["to"]): a for a in told["lever_arms"]}
        self.assertEqual(set(arms), {("imu", "scanner"), ("imu", "antenna"), ("scanner", "antenna")})
        for (_, to), arm in list(arms.items())[:2]:
            for found, true, sigma in zip(arm["forward_right_down_m"], POINTS[to], arm["sigma_m"]):
                self.assertLess(abs(found - true), min(5 * sigma, FARTHEST_OFF))
        self.assertLessEqual(len(told["warnings"]), 1, told["warnings"])  # one sight in a thousand is beyond the test; there are over a hundred
        lines = tomllib.loads((self.out / "lever_arm.toml").read_text())
        for one, to in ((lines["antenna"]["lever_arm"], "antenna"), (lines["calibration"]["lever_arm_scanner"], "scanner")):
            for text, value in zip(one, arms[("imu", to)]["forward_right_down_m"]):
                self.assertAlmostEqual(float(text.removesuffix(" m")), value, delta=0.00006)
        largest = max(arms[("imu", "antenna")]["sigma_m"])
        self.assertAlmostEqual(float(lines["antenna"]["lever_arm_sigma"].removesuffix(" m")), largest, delta=0.00006)
        self.assertGreater(float(lines["sigma"]["lever_arm"].removesuffix(" m")), 0)

    def test_stations_without_error_are_a_warning(self):
        report = self.run_ok(self.hangar, "--set", "lever_arm.hold_stations=true", config=LEVER_ARM)
        found = next(s for s in report["stages"] if s["type"] == "calib.lever_arm")["findings"]
        self.assertIn("held", " ".join(found["warnings"]))

    def test_faults_are_told_before_anything_is_written(self):
        cases = (("distances.csv", "S1,T1,", "S1,T99,", 1, r"distances\.csv:2: no target or point 'T99'"),
                 ("angles.csv", "S1,S2,imu,", "S1,S2,imu,-", 1, r"angles\.csv:2: the angle is -"),
                 ("hangar.toml", 'role = "antenna"', 'role = "antena"', 2, "antenna"),
                 ("hangar.toml", 'angle_unit = "deg"', 'angle_unit = "rad"', 1, "angle is"),
                 ("hangar.toml", "targets.csv", "nowhere.csv", 1, "nowhere.csv"))
        for file, old, new, code, words in cases:
            with self.subTest(file=file, new=new):
                before = (self.folder / file).read_text()
                substitute(self.folder / file, old, new)
                self.assert_refused(self.hangar, code, words, config=LEVER_ARM)
                (self.folder / file).write_text(before)
        self.hangar.write_text('hangar = "none.toml"\n')
        self.assert_refused(self.hangar, 2, "survey.toml:1:10: hangar: no such file", config=LEVER_ARM)
        self.hangar.write_text('crs = "EPSG:32632"\nhangar = "hangar.toml"\n')
        self.assert_refused(self.hangar, 2, r"\[\[laser\]\]|trajectory", config=CONFIG)

    def test_too_few_distances_name_the_station(self):
        rows = (self.folder / "distances.csv").read_text().split("\n")
        kept = [r for r in rows if not r.startswith("S2,T")] + [r for r in rows if r.startswith("S2,T")][:2]
        (self.folder / "distances.csv").write_text("\n".join(r for r in kept if r) + "\n")
        self.assert_refused(self.hangar, 1, "station 'S2' has 2 distances to targets, 3 are needed", config=LEVER_ARM)


if __name__ == "__main__":
    unittest.main()
