# SPDX-License-Identifier: GPL-3.0-or-later
"""Power lines through the whole chain, from simulated raw records, against the true wires and pylons: conductors found and invented, supports, sags with
their sigma. Sums over the seeds. In a scene without a power line everything found is invented.

    corridor.py [--seeds 1 ...] [--scene flat] [--set KEY=VALUE ...]
"""
import argparse
import csv
import sqlite3
import struct

import numpy as np

import common

NEAR = 0.5  # m: a conductor that passes a wire's middle so close is that wire
SUPPORT = 2.0  # m
STAGES = [{"type": "readers.trajectory"}, {"type": "readers.laser"}, {"type": "georeference"}, {"type": "filters.returns"}, {"type": "filters.noise", "neighbours": 2},
          {"type": "filters.outlier"}, {"type": "filters.ground"}, {"type": "terrain.dtm"}, {"type": "filters.hag_dem"}, {"type": "filters.classify"},
          {"type": "terrain.powerlines", "ground": "6 m", "vegetation": "3 m", "building": "5 m", "wire": "1 m", "sheets": "none"}]


def features(geopackage, layer):
    """Fields and vertices of each feature."""
    with sqlite3.connect(geopackage) as base:
        base.row_factory = sqlite3.Row
        for row in base.execute(f'select * from "{layer}"'):
            blob = row["geom"]
            start = 8 + {0: 0, 1: 32, 2: 48, 3: 48, 4: 64}[blob[3] >> 1 & 7]
            kind = (struct.unpack_from("<I", blob, start + 1)[0] & 0xffff) % 1000
            count = struct.unpack_from("<I", blob, start + 5)[0] if kind == 2 else 1
            yield dict(row), np.frombuffer(blob, "<f8", 3 * count, start + (9 if kind == 2 else 5)).reshape(count, 3)


def rows_of(file):
    if not file.exists():
        return []
    with open(file) as text:
        return [{k: float(v) for k, v in row.items()} for row in csv.DictReader(text)]


def height(wire, u):
    return wire["z0"] + wire["a"] * (np.cosh((u - wire["s0"]) / wire["a"]) - 1)


def wire_of(wires, vertices):
    """The true wire that the line runs along where it passes the wire's middle."""
    for k, w in enumerate(wires):
        run = np.hypot(w["x1"] - w["x0"], w["y1"] - w["y0"])
        middle = np.array([(w["x0"] + w["x1"]) / 2, (w["y0"] + w["y1"]) / 2, height(w, run / 2)])
        away = np.linalg.norm(vertices - middle, axis=1)
        near = np.argmin(away)
        if away[near] < 3 and abs(vertices[near, 2] - height(w, (vertices[near, :2] - [w["x0"], w["y0"]]) @ [w["x1"] - w["x0"], w["y1"] - w["y0"]] / run)) < NEAR:
            along = np.array([w["x1"] - w["x0"], w["y1"] - w["y0"]]) / run
            across = (vertices[near, :2] - middle[:2]) @ [-along[1], along[0]]
            if abs(across) < NEAR:
                return k
    return None


given = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
given.add_argument("--seeds", type=int, nargs="+", default=[1])
given.add_argument("--scene", default="flat")
given.add_argument("--line", choices=["true", "false"], default="true", help="a power line in the scene")
given.add_argument("--set", action="append", default=[], help="option of swath simulate, KEY=VALUE")
given = given.parse_args()
options = {"imu.file": "false", "gnss.file": "false", "world.power_line": given.line, **dict(o.split("=", 1) for o in given.set)}
rows, total = [], np.zeros(8)
errors, sigmas = [], []
for seed in given.seeds:
    folder = common.scratch("corridor")
    survey = common.simulate(folder / "survey", seed=seed, world__scene=given.scene, **options)
    common.run(STAGES, survey / "survey.toml", folder / "products")
    wires, pylons = rows_of(survey / "truth/wires.csv"), rows_of(survey / "truth/pylons.csv")
    found, invented, sags = set(), 0, []
    for fields, vertices in features(folder / "products/powerlines.gpkg", "conductors"):
        k = wire_of(wires, vertices)
        if k is None:
            invented += 1
            continue
        found.add(k)
        if fields["sag"] is not None:
            sags.append((fields["sag"] - wires[k]["sag"], fields["sigma_sag"]))
    places = [vertices[0, :2] for _, vertices in features(folder / "products/powerlines.gpkg", "pylons")]
    ends = np.array([[p["x"], p["y"]] for p in pylons]).reshape(-1, 2)
    right = sum(bool(len(ends)) and np.min(np.linalg.norm(ends - p, axis=1)) < SUPPORT for p in places)
    errors += [e for e, _ in sags]
    sigmas += [s for _, s in sags]
    numbers = [len(wires), len(found), invented, len(pylons), right, len(places) - right, len(sags)]
    rows.append([seed, *numbers, f"{1000 * common.rms(np.array([e for e, _ in sags])):.1f}" if sags else "",
                 f"{common.rms(np.array([e / s for e, s in sags])):.2f}" if sags else ""])
    total[:7] += numbers
rows.append(["all", *total[:7].astype(int), f"{1000 * common.rms(np.array(errors)):.1f}" if errors else "",
             f"{common.rms(np.array(errors) / np.array(sigmas)):.2f}" if errors else ""])
common.table(["seed", "wires", "found", "invented", "pylons", "found", "invented", "sags", "rms, mm", "error / sigma"], rows)
