# SPDX-License-Identifier: GPL-3.0-or-later
"""Faults in one flight line or one sensor, and what calib.network makes of them: network_faults.py [SEEDS [FAULT ...]]

SEEDS: their number, or first-last. Three lines and one across over halls, MEMS, fixes of 1 Hz, 400 planes. Faults, all of one kind in one survey:
none; lever (the fixes of line 2 and 15 s about it 15 cm to the east, as by a wrong lever arm); hour (all fixes after line 2 shifted by 8, -5, 12 cm:
another base); jump (returns of line 2 10 ms late); jump_within (all returns from the middle of line 2 on 10 ms late); gyro_x, gyro_z_turn,
accelerometer_z (that axis frozen for 1 s: in the middle of line 2, in the turn before it). For each: errors within the lines, smoother and network,
error/sigma, groups left out, and what the program said."""
import csv
import json
import os
import shutil
import sys
import tomllib

import numpy as np

import common
import network

SURVEY = {**network.SURVEY, "flight.lines": 3, "flight.bank": "30 deg", "world.length": "500 m", "world.width": "400 m", "output.truth_returns": "false"}
STAGES = [{"type": t} for t in ("readers.imu", "readers.gnss", "readers.laser")] + [{"type": "calib.network", "planes.planes": 400, "sections": 0},
                                                                                 {"type": "writers.trajectory"}]
INTEGERS = ("n_sat", "quality")


def table(file):
    with open(file, newline="") as source:
        rows = list(csv.reader(source))
    return rows[0], np.array(rows[1:], float)


def write(file, head, values):
    with open(file, "w", newline="") as out:
        csv.writer(out).writerows([head] + [[int(v) if h in INTEGERS else repr(float(v)) for h, v in zip(head, row)] for row in values])


def shift_fixes(survey, first, last, east_north_up):
    head, values = table(survey / "gnss.csv")
    lat, lon = np.radians(values[0, [head.index("lat_deg"), head.index("lon_deg")]])
    axes = np.array([[-np.sin(lon), np.cos(lon), 0], [-np.sin(lat) * np.cos(lon), -np.sin(lat) * np.sin(lon), np.cos(lat)],
                     [np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon), np.sin(lat)]])
    within = (values[:, 0] >= first) & (values[:, 0] <= last)
    values[np.ix_(within, [head.index(f"ecef_{a}_m") for a in "xyz"])] += np.asarray(east_north_up) @ axes
    write(survey / "gnss.csv", head, values)


def freeze(survey, start, column, length=1.0):
    head, values = table(survey / "imu.csv")
    within = np.flatnonzero((values[:, 0] >= start) & (values[:, 0] < start + length))
    values[within, head.index(column)] = values[within[0] - 1, head.index(column)]
    write(survey / "imu.csv", head, values)


def delay(survey, first, last, seconds):
    shots = np.load(survey / "laser.npy")
    shots["time"][(shots["time"] >= first) & (shots["time"] <= last)] += seconds
    np.save(survey / "laser.npy", shots)


def put(fault, survey):
    lines = [tuple(float(l[k].split()[0]) for k in ("start", "end")) for l in tomllib.loads((survey / "survey.toml").read_text())["line"]]
    first, second, third = lines[:3]
    middle, turn = np.mean(second), (first[1] + second[0]) / 2
    {"none": lambda: None,
     "lever": lambda: shift_fixes(survey, second[0] - 15, second[1] + 15, (0.15, 0, 0)),
     "hour": lambda: shift_fixes(survey, (second[1] + third[0]) / 2, np.inf, (0.08, -0.05, 0.12)),
     "jump": lambda: delay(survey, second[0] - 1, second[1] + 1, 0.010),
     "jump_within": lambda: delay(survey, middle, np.inf, 0.010),
     "gyro_x": lambda: freeze(survey, middle, "dtheta_x_rad"),
     "gyro_z_turn": lambda: freeze(survey, turn, "dtheta_z_rad"),
     "accelerometer_z": lambda: freeze(survey, middle, "dv_z_mps")}[fault]()


FAULTS = ("none", "lever", "hour", "jump", "jump_within", "gyro_x", "gyro_z_turn", "accelerometer_z")


def fly(fault, seed):
    folder = common.scratch(f"network_faults/{fault}_{seed}")
    off = network.LEVER * np.random.default_rng(seed).normal(size=3)
    survey, output = folder / "survey", folder / "out"
    common.call("simulate", survey, "--quiet", *common.sets({**SURVEY, "seed": seed, "gnss.lever_arm_error": json.dumps([f"{v:.4f} m" for v in off]),
                                                             "gnss.lever_arm_sigma": f"{network.LEVER} m"}))
    put(fault, survey)
    report = common.run(STAGES, survey / "survey.toml", output)
    found = json.loads((output / "network.json").read_text())
    frozen = [f"{k}: {v['examples'][0].split('/')[-1]}" for k, v in common.stage_of(report, "readers.imu")["tally"].items() if "frozen" in k]
    warned = common.stage_of(report, "calib.network")["tally"].get("warnings of the smoother", {"examples": []})["examples"]
    if not os.environ.get("KEEP"):
        shutil.rmtree(folder)
    return found, frozen + warned


def row(fault, seed, found, which):
    of = [found["truth"][which]["lines"][c] for c in network.COMPONENTS]
    return [fault, seed, which, " ".join(f"{100 * c['rms_m']:.1f}" for c in of[:3]), " ".join(f"{c['rms_arcsec']:.1f}" for c in of[3:]),
            " ".join(f"{c.get('error_over_sigma', np.nan):.2f}" for c in of), found["groups_left_out"]]


def main():
    first, _, last = (sys.argv[1] if len(sys.argv) > 1 else "1").rpartition("-")
    rows = []
    for fault in sys.argv[2:] or FAULTS:
        for seed in range(int(first or 1), int(last) + 1):
            found, frozen = fly(fault, seed)
            rows += [row(fault, seed, found, which) for which in ("smoother", "network")]
            for what in found.get("findings", []) + frozen:
                print(f"- {fault}, seed {seed}: {what}", flush=True)
    common.table(["fault", "seed", "trajectory", "rms N E D cm", "roll pitch heading arcsec", "error/sigma N E D roll pitch heading", "groups left out"], rows)


if __name__ == "__main__":
    main()
