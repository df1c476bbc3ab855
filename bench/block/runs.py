# SPDX-License-Identifier: GPL-3.0-or-later
"""configs/block.toml on raw IMU, GNSS and exposures over seeds: errors over standard deviations of direct orientation, and of the adjusted
perspective centres, attitudes, points, cameras and check points.

    python3 bench/block/runs.py build/release/tools/swath 20 [--set block.adjust.robust=false ...]
"""
import json
import math
import sqlite3
import struct
import sys
import tempfile
import tomllib
from pathlib import Path

from blocks import times, turn
from flights import BORESIGHT, FLIGHT, Sums, call, compare, rows_of

CONFIG = Path(__file__).resolve().parents[2] / "configs" / "block.toml"
MOUNTED = [[0, 1, 0], [1, 0, 0], [0, 0, -1]]  # 90 deg
LEVER_ARM = (0.21, -0.08, 0.34)
CAMERA = {"f": 50.21, "x0": 0.021, "y0": -0.034, "k1": -2.1e-5, "k2": 1.2e-8, "p1": 3e-6, "p2": -4e-6}
FLIGHT = [s for s in FLIGHT if "_sigma" not in s]  # the mounting has errors here


def mounting(degrees):
    r, p, h = map(math.radians, degrees)
    return times(times(turn(2, h), times(turn(1, p), turn(0, r))), MOUNTED)


def points_of(layer):
    """{name: (place, sigmas)} of a GeoPackage of points with heights."""
    out = {}
    for row in sqlite3.connect(layer).execute("select name, geom, sigma_east, sigma_north, sigma_up from points"):
        out[row[0]] = (struct.unpack_from("<3d", row[1], len(row[1]) - 24), row[2:])
    return out


def fly(program, seed, more, sums):
    with tempfile.TemporaryDirectory() as made:
        flown = Path(made) / "flown"
        out = flown / "out"
        call(program, "simulate", flown, "--quiet", "--set", f"seed={seed}", *(w for s in FLIGHT for w in ("--set", s)))
        call(program, "run", CONFIG, "--survey", flown / "survey.toml", "--output", out, "--quiet", "--set", "orientation.direct.correlated_images=30", *more)
        stated = tomllib.loads((flown / "survey.toml").read_text())["camera"][0]
        truth = rows_of(flown / "truth" / "images.csv")
        direct, boresight = rows_of(out / "orientation_direct.csv"), [float(a.split()[0]) for a in stated["boresight"]]
        compare(sums, "direct", direct, truth, mounting(boresight))
        sigma = float(stated["sigma"]["boresight"].split()[0])
        for name, given, true_angle in zip(("roll", "pitch", "heading"), boresight, BORESIGHT):
            sums.note(f"stated boresight {name}, deg", given - true_angle, sigma)
        compare(sums, "direct, true boresight:", direct, truth, mounting(BORESIGHT), positions=False, known=math.radians(sigma))
        block = json.loads((out / "block" / "block.json").read_text())
        values = {v["name"]: v for v in block["cameras"][0]["values"]}
        angles = [values[f"boresight_{k}"]["value"] for k in ("roll", "pitch", "heading")]
        compare(sums, "integrated", rows_of(out / "block" / "orientation.csv"), truth, mounting(angles))
        for d in block["direct"]:
            sums.note("differences direct/integrated, over their own sigma", d["rms_over_sigma"], 1.0)
        true = {r["name"]: r for r in rows_of(flown / "truth" / "camera_points.csv")}
        for name, (place, sigmas) in points_of(out / "block" / "points.gpkg").items():
            for axis, at, sigma in zip("xyz", place, sigmas):
                sums.note(f"points {'plan' if axis < 'z' else 'height'}, m", at - float(true[name][axis]), sigma)
        for c in block["check"]:
            sums.add(f"check points {c['coordinate']}, m", c["over_sigma"] ** 2 * c["points"], c["rms_m"] ** 2 * c["points"], c["points"])
        for name, true_value in CAMERA.items():
            sums.note(f"camera {'f, x0, y0, mm' if len(name) < 2 or name[1] == '0' else name}", values[name]["value"] - true_value, values[name]["sigma"])
        for name, true_angle in zip(("roll", "pitch", "heading"), BORESIGHT):
            v = values[f"boresight_{name}"]
            sums.note("boresight, deg", v["value"] - true_angle, v["sigma"])
        for name, given, true_part in zip(("forward", "right", "down"), stated["lever_arm"], LEVER_ARM):
            v = values[f"antenna_{name}"]
            sums.note("lever arm, m", v["value"] - (float(given.split()[0]) - true_part), v["sigma"])


def main(program, number=20, *more):
    sums = Sums()
    for seed in range(1, int(number) + 1):
        sums.begin()
        fly(program, seed, more, sums)
        print(f"--- {seed} flights", *sums.lines(), sep="\n", flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
