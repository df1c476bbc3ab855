# SPDX-License-Identifier: GPL-3.0-or-later
"""Simulated IMU and GNSS records along a real airborne trajectory of 73 s, and that trajectory recovered from them: houston.py [SEEDS]"""
import sys

import numpy as np

import common
import navigation

ALONG = """[{{file = "{}", crs = "EPSG:32615", angle_unit = "deg", time = {{scale = "gps_week", week = 1700}}, columns = {{time = "GpsTime",
latitude = "Y", longitude = "X", height = "Z", roll = "Roll", pitch = "Pitch", heading = "Azimuth"}}}}]""".replace("\n", " ")

data = common.reference("sbet_houston")
along = ALONG.format(data / "sbet_047_IGS08-UTM15N-Ellipsoid-trim.txt")
seeds = int(sys.argv[1]) if len(sys.argv) > 1 else 5
head = ["grade", "seeds", "rms N, E, D cm", "rms roll, pitch, heading arcsec", "error/sigma N E D", "error/sigma roll pitch heading", "NEES (9)", "NIS (3)",
        "runs with warnings"]
rows = []
for grade in ("navigation", "tactical"):
    rms, squares, nees, nis, warned = [], [], [], [], []
    for seed in range(1, seeds + 1):
        folder = common.scratch("houston")
        survey = common.simulate(folder / "survey", seed=seed, crs="EPSG:32615", output__laser="false", output__trajectory="none", flight__along=along,
                                 imu__grade=grade, gnss__sigma_horizontal="2.5 cm", gnss__sigma_vertical="4.5 cm")
        output = folder / "out"
        common.run(common.ROOT / "configs/trajectory.toml", survey / "survey.toml", output, ins_gnss__plots="[]")
        flown, truth = navigation.sbet(output / "trajectory.sbet"), navigation.sbet(survey / "truth/sbet.out")
        time, error, inside = navigation.errors(flown, truth)
        spread = navigation.sigmas(output / "trajectory.smrmsg")[inside]
        one = navigation.measures(error, np.concatenate([spread[:, 1:4], spread[:, 7:10]], axis=1))
        report = navigation.findings(output)
        rms.append(one[0])
        squares.append(one[1])
        nees.append([navigation.nees(output, flown, truth, [(time[0], time[-1])])])
        nis.append([report["innovations"]["mean_nis"]])
        warned += [w for w in report["warnings"][:1]]
    rows.append([grade, seeds, navigation.ranges([r[:3] for r in rms]), navigation.ranges([r[3:] for r in rms], 1), navigation.pooled([s[:3] for s in squares]),
                 navigation.pooled([s[3:] for s in squares]), navigation.ranges(nees), navigation.ranges(nis), f"{len(warned)} " + " | ".join(sorted(set(warned)))])
common.table(head, rows)
