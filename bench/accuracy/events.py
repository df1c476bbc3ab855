# SPDX-License-Identifier: GPL-3.0-or-later
"""Sigma of events against their true error: simulated flights with turns at 1, 2 and 5 Hz, 20 seeds, and a drive with RTK thinned to 1 and 2 Hz: events.py [SEEDS]

Events every 0.37 s of the whole flight, turns among them; the truth is the antenna's place in truth/sbet.out. Of the drive the fixes that thinning took away
are the truth; the sigma of a difference holds their own white error. Seeds 1 to 10 were looked at while the method was made, the others were not: both are
listed. A seed's fixes have errors of two minutes' memory, so that a flight's own ratio scatters by a quarter."""
import csv
import re
import sys

import numpy as np

import common
import navigation

RATES = (1, 2, 5)
SEEN = 10
STEP, EDGE = 0.37, 8.0  # s; without a full window at either end
FLIGHT = {"output__laser": "false", "flight__lines": 4, "flight__line_length": "2000 m", "flight__cross_lines": 1, "imu__rate": "50 Hz",
          "mounting__lever_arm_antenna": '["0 m", "0 m", "0 m"]'}
EVENTS = """
[[event]]
file = "times.csv"
time = {{ scale = "gps_week", week = {week} }}
columns = {{ time = "t" }}
"""
DRIVE = """name = "drive"
crs = "EPSG:32613"

[[gnss]]
file = "{file}"
"""


def error_over_sigma(folder, method):
    """Of each event east, north, height; and whether it lies in a turn."""
    truth = navigation.sbet(folder / "truth/sbet.out")
    survey = (folder / "survey.toml").read_text()
    week = int(re.search(r"week = (\d+)", survey).group(1))
    times = np.arange(truth[0, 0] + EDGE, truth[-1, 0] - EDGE, STEP)
    (folder / "times.csv").write_text("t\n" + "".join(f"{t:.6f}\n" for t in times))
    (folder / "events.toml").write_text(re.sub(r"\[\[event\]\].*?(?=\n\[|\Z)", "", survey, flags=re.S) + EVENTS.format(week=week))
    stages = [{"type": "readers.gnss"}, {"type": "time.sync"}, {"type": "trajectory.kinematic", "method": method}]
    common.run(stages, folder / "events.toml", folder / "out")
    rows = [r for r in csv.DictReader((folder / "out/events.csv").open()) if r["x"]]
    column = lambda *names: np.array([[float(r[n]) for n in names] for r in rows])
    seconds = column("gps_time")[:, 0] - 604800.0 * week
    at = lambda k: np.interp(seconds, truth[:, 0], truth[:, k])
    lat, lon, h = at(1), at(2), at(3)
    n = navigation.A / np.sqrt(1 - navigation.E2 * np.sin(lat) ** 2)
    place = np.stack([(n + h) * np.cos(lat) * np.cos(lon), (n + h) * np.cos(lat) * np.sin(lon), (n * (1 - navigation.E2) + h) * np.sin(lat)], axis=1)
    d = column("x", "y", "z") - place
    east = np.stack([-np.sin(lon), np.cos(lon), 0 * lon], axis=1)
    up = np.stack([np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon), np.sin(lat)], axis=1)
    error = np.stack([np.sum(d * a, axis=1) for a in (east, np.cross(up, east), up)], axis=1)
    turning = np.abs(np.interp(seconds, truth[1:, 0], np.diff(np.unwrap(navigation.heading(truth))) / np.diff(truth[:, 0]))) > np.radians(2)
    return error / column("sigma_east", "sigma_north", "sigma_up"), error, turning


def rms(values):
    return np.sqrt(np.mean(np.square(values), axis=0))


def simulated(seeds):
    print(f"error over sigma, rms E N H over {seeds} seeds | seeds 1-{SEEN} | the others | turns | straight | rms of the error, cm")
    for rate in RATES:
        found = {m: [] for m in ("kalman", "rts")}
        for seed in range(1, seeds + 1):
            folder = common.scratch("events/flight")
            common.simulate(folder, seed=seed, gnss__rate=f"{rate} Hz", **FLIGHT)
            for method in found:
                found[method].append(error_over_sigma(folder, method))
        for method, flights in found.items():
            ratio = lambda some: rms(np.concatenate(some)) if len(some) else np.full(3, np.nan)
            cells = [ratio([f[0] for f in flights]), ratio([f[0] for f in flights[:SEEN]]), ratio([f[0] for f in flights[SEEN:]]),
                     ratio([f[0][f[2]] for f in flights]), ratio([f[0][~f[2]] for f in flights])]
            error = 100 * rms(np.concatenate([f[1] for f in flights]))
            print(f"{rate} Hz {method:7}", *(" ".join(f"{v:.2f}" for v in c) for c in cells), " ".join(f"{v:.1f}" for v in error), sep=" | ", flush=True)


def drive():
    folder = common.scratch("events/drive")
    file = common.reference("car_imu_rtk", "drive_0708", "gnss_1934_sf.pos")
    (folder / "survey.toml").write_text(DRIVE.format(file=file))
    stages = [{"type": "readers.gnss"}, {"type": "trajectory.kinematic", "leave_one_out": True, "rates": [1, 2]}]
    common.run(stages, folder / "survey.toml", folder / "out")
    print("\ndrive, fixes of 4 Hz thinned:\n" + (folder / "out/rates.txt").read_text())


if __name__ == "__main__":
    simulated(int(sys.argv[1]) if len(sys.argv) > 1 else 20)
    drive()
