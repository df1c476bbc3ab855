# SPDX-License-Identifier: GPL-3.0-or-later
"""Buildings of simulated towns against the true ones: found and invented, area and position of outlines, heights, planes.

    buildings.py [--seeds 1 ...] [--scene town] [--set KEY=VALUE ...] [--option KEY=VALUE ...]

A true building is found where an outline covers more than half of its area, an outline is right where more than half of its own area is of true
buildings. Buildings within 8 m of the rim of the surveyed area are not judged. Positions: outline sides of found buildings every 0.5 m, distance to the nearest
true wall, outwards positive. Heights: ridge and eaves as heights of the map against the true roof; heights above ground against the lowest true ground along the
wall, 1 m outside."""
import argparse
import csv
import sqlite3
import struct

import numpy as np

import common

STAGES = [{"type": "readers.trajectory"}, {"type": "readers.laser"}, {"type": "georeference"}, {"type": "filters.returns"}, {"type": "filters.noise"},
          {"type": "filters.ground"}, {"type": "terrain.dtm", "cell": "50 cm"}, {"type": "filters.hag_dem"}, {"type": "filters.classify"}]
RIM = 8.0  # m of the surveyed area's rim that is not judged


def inside(ring, p):
    """Which places lie in a ring."""
    a, b = ring, np.roll(ring, -1, axis=0)
    x, y = p[:, None, 0], p[:, None, 1]
    with np.errstate(divide="ignore", invalid="ignore"):
        crosses = ((a[:, 1] <= y) != (b[:, 1] <= y)) & (x < a[:, 0] + (y - a[:, 1]) / (b[:, 1] - a[:, 1]) * (b[:, 0] - a[:, 0]))
    return crosses.sum(axis=1) % 2 == 1


def away(ring, p):
    """m from places to the nearest side of a ring."""
    a, side = ring, np.roll(ring, -1, axis=0) - ring
    t = np.clip(((p[:, None] - a) * side).sum(axis=2) / (side ** 2).sum(axis=1), 0, 1)
    return np.linalg.norm(p[:, None] - a - t[..., None] * side, axis=2).min(axis=1)


def along(ring, step):
    out = []
    for a, b in zip(ring, np.roll(ring, -1, axis=0)):
        n = max(1, int(np.ceil(np.linalg.norm(b - a) / step)))
        out.append(a + (np.arange(n)[:, None] + 0.5) / n * (b - a))
    return np.concatenate(out)


def area(ring):
    x, y = (ring - ring[0]).T
    return 0.5 * abs(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1)))


def convex(points):
    """Convex hull in plan."""
    points = sorted(set(map(tuple, points)))
    out = []
    for pass_ in (points, points[::-1]):
        begin = len(out)
        for p in pass_:
            while len(out) >= begin + 2 and (out[-1][0] - out[-2][0]) * (p[1] - out[-2][1]) <= (out[-1][1] - out[-2][1]) * (p[0] - out[-2][0]):
                out.pop()
            out.append(p)
        out.pop()
    return np.array(out)


def true_buildings(folder):
    """Footprint, eaves, ridge and number of roof planes of each building."""
    roofs = {}
    with open(folder / "truth/planes.csv") as text:
        for row in csv.DictReader(text):
            if row["kind"] == "roof":
                name = row["name"].rsplit(" roof ", 1)[0]
                roofs.setdefault(name, []).append(np.array([[float(v) for v in c.split()] for c in row["corners"].split(";")]))
    return [{"ring": convex(np.round(np.concatenate(r)[:, :2], 4)), "eaves": min(c[:, 2].min() for c in r), "ridge": max(c[:, 2].max() for c in r), "planes": len(r)}
            for name, r in roofs.items() if not name.startswith("bridge")]


def polygons(file, layer):
    """Rings and fields of a layer of polygons in a GeoPackage."""
    out = []
    with sqlite3.connect(file) as base:
        names = [c[1] for c in base.execute(f"pragma table_info({layer})")]
        for row in base.execute(f"select * from {layer}"):
            fields = dict(zip(names, row))
            blob = fields.pop("geom")
            at = 8 + {0: 0, 1: 32, 2: 48, 3: 48, 4: 64}[(blob[3] >> 1) & 7]
            kind, rings = struct.unpack_from("<II", blob, at + 1)
            width, at, parts = (3 if kind > 1000 else 2), at + 9, []
            for _ in range(rings):
                n, = struct.unpack_from("<I", blob, at)
                parts.append(np.frombuffer(blob, "<f8", n * width, at + 4).reshape(n, width)[:-1])
                at += 4 + 8 * n * width
            out.append({**fields, "rings": parts})
    return out


def judge(seed, given, options, stage):
    folder = common.scratch("buildings")
    survey = common.simulate(folder / "survey", seed=seed, world__scene=given.scene, **options)
    common.run([*STAGES, stage], survey / "survey.toml", folder / "products")
    true, found = true_buildings(survey), polygons(folder / "products/buildings.gpkg", "buildings")
    ground, place = common.raster(survey / "truth/dtm.tif")
    returns = np.load(survey / "truth/returns.npy", mmap_mode="r")
    low, high = (np.array([f(returns["e"]), f(returns["n"])]) + m for f, m in ((np.min, RIM), (np.max, -RIM)))
    whole = lambda ring: np.all(ring > low) and np.all(ring < high)
    places = lambda ring: [np.arange(ring[:, k].min(), ring[:, k].max(), 0.25) + 0.125 for k in (0, 1)]
    grid = lambda ring: np.stack(np.meshgrid(*places(ring)), -1).reshape(-1, 2)
    sums = dict.fromkeys(("true", "found", "outlines", "right", "parts"), 0)
    errors = {k: [] for k in ("area", "position", "ridge", "eaves", "height", "planes")}
    for b in found:
        ring = b["rings"][0]
        if b["cut"] or not whole(ring):
            continue
        p = grid(ring)
        p = p[inside(ring, p)]
        sums["outlines"] += 1
        sums["right"] += np.any([inside(t["ring"], p) for t in true], axis=0).mean() > 0.5
    for t in true:
        if not whole(t["ring"]):
            continue
        p = grid(t["ring"])
        p = p[inside(t["ring"], p)]
        shares = [inside(b["rings"][0], p).mean() for b in found]
        sums["true"] += 1
        best = int(np.argmax(shares))
        if shares[best] <= 0.5:
            continue
        sums["found"] += 1
        b = found[best]
        ring = b["rings"][0]
        q = grid(ring)
        of_all = sum(inside(o["ring"], q[inside(ring, q)]).mean() > 0.1 for o in true)
        if of_all > 1 or b["cut"]:
            sums["parts"] += of_all > 1
            continue  # joined with a neighbour: its figures are of both
        errors["area"].append(b["area"] / area(t["ring"]) - 1)
        p = along(ring, 0.5)
        errors["position"].append(away(t["ring"], p) * np.where(inside(t["ring"], p), -1, 1))
        errors["ridge"].append(b["roof_ridge"] - t["ridge"])
        errors["eaves"].append(b["roof_eaves"] - t["eaves"])
        w = along(t["ring"], 1.0)
        centre = t["ring"].mean(axis=0)
        w = w + (w - centre) / np.linalg.norm(w - centre, axis=1)[:, None]
        errors["height"].append(b["ridge"] - (t["ridge"] - np.nanmin(common.nearest(ground, place, w[:, 0], w[:, 1]))))
        errors["planes"].append(b["planes"] - t["planes"])
    return sums, errors


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--seeds", type=int, nargs="+", default=[1])
    p.add_argument("--scene", default="town")
    p.add_argument("--set", action="append", default=[], help="option of swath simulate, KEY=VALUE")
    p.add_argument("--option", action="append", default=[], help="option of terrain.buildings, KEY=VALUE")
    given = p.parse_args()
    options = {"imu.file": "false", "gnss.file": "false", "world.length": "400 m", "world.width": "300 m", **dict(o.split("=", 1) for o in given.set)}
    stage = {"type": "terrain.buildings", **{k: v in ("true", "True") if v in ("true", "false") else v for k, v in (o.split("=", 1) for o in given.option)}}
    rows, sums, errors = [], {}, {}
    figures = lambda s, e: [s["true"], s["found"], s["outlines"], s["right"], s["parts"],
                            f"{100 * np.median(e['area']):+.1f}", f"{100 * common.rms(e['area']):.1f}",
                            f"{np.mean(np.concatenate(e['position'])):+.2f}", f"{common.rms(np.concatenate(e['position'])):.2f}",
                            *(f"{f(e[k]):.2f}" for k in ("ridge", "eaves", "height") for f in (np.median, common.rms)), f"{100 * np.mean(np.array(e['planes']) == 0):.0f}"]
    for seed in given.seeds:
        s, e = judge(seed, given, options, stage)
        rows.append([seed, *figures(s, e)])
        sums = {k: sums.get(k, 0) + v for k, v in s.items()}
        errors = {k: errors.get(k, []) + v for k, v in e.items()}
    rows.append(["all", *figures(sums, errors)])
    common.table(["seed", "buildings", "found", "outlines", "right", "joined", "area, median %", "rms %", "sides, mean m", "rms m", "ridge, median m", "rms m",
                  "eaves, median m", "rms m", "height, median m", "rms m", "planes right %"], rows)


if __name__ == "__main__":
    main()
