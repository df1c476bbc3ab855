# SPDX-License-Identifier: GPL-3.0-or-later
"""Real labelled clouds through the program, judged by their makers' classes: ground, terrain, classes, stated probability, CPU.

    real.py [NAME ...] [--chain NAME=STAGES] [--json FILE]

NAME: a part of a cloud's name (clouds.py); none: all. STAGES: a JSON list, the chain of filters judged in place of the default.
The program never sees the labels: it reads copies whose classes are blank.
"""
import argparse
import json
import resource
import sys
import time

import numpy as np

import clouds
from clouds import common
from peaks import peaks

BLANK = 1  # class of every point that the program is given
CHAIN = [{"type": "filters.noise"}, {"type": "filters.ground"}, {"type": "filters.water"}]
PRODUCTS = [{"type": "terrain.dtm", "cell": "1 m"}, {"type": "filters.hag_dem"}, {"type": "filters.classify"},
            {"type": "writers.las", "compress": False}, {"type": "writers.gdal"}]
RIMS = ((0, 5), (5, 12), (12, np.inf))
KINDS = {"ground": (2, 8), "vegetation": (3, 4, 5), "building": (6,), "noise": (7, 18), "water": (9,), "wire": (13, 14, 15, 16), "bridge": (17,)}


def arguments():
    given = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    given.add_argument("names", nargs="*")
    given.add_argument("--chain", default="", help="NAME=STAGES")
    given.add_argument("--json", help="figures of every cloud, for comparisons")
    return given.parse_args()


def cpu():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def run(cloud, chain):
    """The source; points in its order; terrain models of the run and of the maker's own ground; what the run cost; its report."""
    folder = common.scratch(f"real/{cloud.name.replace(' ', '_')}")
    source = cloud.read()
    clouds.copy_of(cloud, source, folder, np.full(len(source.points), BLANK, np.uint8))
    before, start = cpu(), time.monotonic()
    report = common.run([{"type": "readers.las"}, *chain, *PRODUCTS], folder / "survey.toml", folder / "out")
    cost = {"cpu": cpu() - before, "wall": time.monotonic() - start}
    points = common.points_of(folder / "out")
    order = clouds.order_of(points, source)
    clouds.copy_of(cloud, source, folder / "maker", np.where(np.isin(source.classification, cloud.ground), 2, BLANK).astype(np.uint8))
    common.run([{"type": "readers.las"}, PRODUCTS[0], {"type": "writers.gdal"}], folder / "maker/survey.toml", folder / "maker/out")
    models = [common.raster(folder / out / "dtm.vrt") for out in ("out", "maker/out")]
    return source, {name: column[order] for name, column in points.items()}, models, cost, report


def terrain(models, rim):
    """Differences of the cells that both terrain models cover, NaN where ours alone is missing; their distance from the rim."""
    (ours, place), (theirs, other) = models
    i, j = np.nonzero(np.isfinite(theirs))
    x, y = other.c + (j + 0.5) * other.a, other.f + (i + 0.5) * other.e
    return common.nearest(ours, place, x, y) - theirs[i, j], rim(x, y)


def judge(cloud, chain):
    source, points, models, cost, report = run(cloud, chain)
    labels = np.asarray(source.classification).astype(int)
    said = points["classification"].astype(int)
    judged = ~np.isin(labels, cloud.ignored)
    ground = np.isin(labels, cloud.ground)
    x, y = np.asarray(source.x), np.asarray(source.y)
    rim = clouds.Rim(x, y)
    error, far = terrain(models, rim)
    found = {"name": cloud.name, "points": len(labels), "agreement": common.agreement(ground[judged], said[judged] == 2), **cost,
             "ground": ground[judged], "said": said[judged], "labels": labels[judged], "rim": rim(x, y)[judged], "error": error, "far": far,
             "probability": points["ground_probability"][judged].astype(float) if "ground_probability" in points else np.array([])}
    groups, falls = peaks(x, y, np.asarray(source.z), said == 2)
    found["peaks"] = [len(groups), sum(map(len, groups)), int(sum(ground[g].sum() for g in groups)), max(falls, default=0.0)]
    found["rates"] = {s["type"]: s["counts"]["in"] / max(s["seconds"], 1e-9) / 1e6 for s in report["stages"] if "counts" in s and "seconds" in s}
    return found


def share(part, of):
    return f"{100 * np.mean(part[of]):.2f}" if np.any(of) else "-"


def label_table(found):
    rows = []
    for f in found:
        take = [share(f["said"] == 2, ~f["ground"] & (f["rim"] >= low) & (f["rim"] < high)) for low, high in ((0, 12), (12, np.inf))]
        rows.append([f["name"], f["points"], *common.cells(f["agreement"]), *take, f"{f['cpu']:.1f}", f"{f['points'] / f['wall'] / 1e6:.2f}"])
    common.table(["cloud", "points", "type I %", "type II %", "total %", "kappa %", "type II within 12 m of the rim", "beyond", "CPU s", "M points/s"], rows)
    for group in ("isprs", "ign", "ahn3"):
        mine = [f["agreement"] for f in found if f["name"].startswith(group)]
        if len(mine) > 1:
            print(f"mean of {group}: type I, II, total, kappa", *common.cells(np.mean(mine, axis=0)))
    print()


def terrain_table(found):
    rows = []
    for f in found:
        for low, high in RIMS:
            here = (f["far"] >= low) & (f["far"] < high)
            e = f["error"][here]
            known = e[np.isfinite(e)]
            if len(known):
                rows.append([f["name"], f"{low}-{high}", len(e), len(e) - len(known), f"{np.median(known):+.3f}", f"{common.rms(known):.3f}",
                             f"{100 * np.mean(np.abs(known) > 0.5):.2f}"])
    print("Terrain model minus that of the maker's ground, cells of 1 m by distance from the rim\n")
    common.table(["cloud", "from the rim m", "cells", "without height", "median m", "rms m", "off by > 0.5 m %"], rows)


def peak_table(found):
    print("Ground points alone high above all ground around\n")
    common.table(["cloud", "groups", "points", "of them the maker's ground", "highest m"], [[f["name"], *f["peaks"][:3], f"{f['peaks'][3]:.1f}"] for f in found])


def class_table(found):
    rows = []
    for f in found:
        cloud = next(c for c in clouds.ALL if c.name == f["name"])
        for name, theirs, mine in (("building", cloud.building, (6,)), ("bridge", cloud.bridge, (17,)), ("water", cloud.water, (9,))):
            true, said = np.isin(f["labels"], theirs), np.isin(f["said"], mine)
            if true.any():
                rows.append([f["name"], name, true.sum(), said.sum(), share(said, true), share(true, said)])
    print("Classes\n")
    common.table(["cloud", "class", "points", "found", "completeness %", "correctness %"], rows)
    rows = []
    for f in found:
        for label in np.unique(f["labels"]):
            here = f["labels"] == label
            rows.append([f["name"], label, here.sum(), *(share(np.isin(f["said"], k), here) for k in KINDS.values()), share(f["said"] <= 1, here)])
    print("Confusion: the maker's class, and what the program calls it, %\n")
    common.table(["cloud", "class", "points", *KINDS, "unclassified"], rows)


def reliability(p, ground):
    """Rows of decile, returns, stated and true share; the largest gap among deciles of at least 200 returns."""
    decile, rows, worst = np.minimum((10 * p).astype(int), 9), [], 0.0
    for k in range(10):
        here = decile == k
        if here.any():
            stated, true = p[here].mean(), ground[here].mean()
            rows.append([f"{k / 10:.1f}-{(k + 1) / 10:.1f}", here.sum(), f"{stated:.3f}", f"{true:.3f}"])
            worst = max(worst, abs(stated - true)) if here.sum() >= 200 else worst
    return rows, worst


def probability_tables(found):
    stated = [f for f in found if len(f["probability"])]
    if not stated:
        return
    clean = [(f["name"], f["probability"][ok], f["ground"][ok]) for f in stated for ok in [(f["probability"] >= 0) & (f["probability"] <= 1)]]
    print("Stated probability of ground\n")
    common.table(["cloud", "largest gap of a decile", "Brier score"], [[n, f"{reliability(p, g)[1]:.3f}", f"{np.mean((p - g) ** 2):.4f}"] for n, p, g in clean])
    # Every cloud counts alike, so that the largest does not decide.
    each = min(20000, max(len(p) for _, p, _ in clean))
    pick = [np.random.default_rng(1).integers(0, len(p), each) for _, p, _ in clean]
    rows, _ = reliability(np.concatenate([p[k] for (_, p, _), k in zip(clean, pick)]), np.concatenate([g[k] for (_, _, g), k in zip(clean, pick)]))
    common.table(["stated, all clouds with equal weight", "returns", "mean stated", "truly ground"], rows)


def main():
    given = arguments()
    chain = json.loads(given.chain.partition("=")[2]) if given.chain else CHAIN
    found = []
    for cloud in clouds.named(given.names):
        print(cloud.name, file=sys.stderr, flush=True)
        found.append(judge(cloud, chain))
    label_table(found)
    terrain_table(found)
    peak_table(found)
    class_table(found)
    probability_tables(found)
    rates = sorted({name for f in found for name in f["rates"] if name.startswith(("filters.", "terrain."))})
    print("M points per second of each stage's own time, summed over threads with tiles of their own\n")
    common.table(["cloud", *rates], [[f["name"], *(f"{f['rates'].get(r, float('nan')):.2f}" for r in rates)] for f in found])
    if given.json:
        kept = [{k: v for k, v in f.items() if not isinstance(v, np.ndarray)} for f in found]
        open(given.json, "w").write(json.dumps(kept, indent=1, default=float))


if __name__ == "__main__":
    main()
