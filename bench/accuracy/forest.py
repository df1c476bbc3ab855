# SPDX-License-Identifier: GPL-3.0-or-later
"""Trees of simulated forests against the true ones: found and invented tops, heights, crowns; canopy cover against the true crowns.

    forest.py [--seeds 1 ...] [--scene forest] [--set KEY=VALUE ...] [--option KEY=VALUE ...]

A true tree that stands within another's crown and is lower has no top of its own: it is counted as covered. A top belongs to a tree where it lies within
its crown. Sums over the seeds."""
import argparse
import csv

import numpy as np

import common

STAGES = [{"type": "readers.trajectory"}, {"type": "readers.laser"}, {"type": "georeference"}, {"type": "filters.returns"}, {"type": "filters.noise"},
          {"type": "filters.ground"}, {"type": "terrain.dtm"}, {"type": "filters.hag_dem"}, {"type": "filters.classify"}]
EDGE = 10.0  # m of the surveyed area's rim that is not judged

given = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
given.add_argument("--seeds", type=int, nargs="+", default=[1])
given.add_argument("--scene", default="forest")
given.add_argument("--set", action="append", default=[], help="option of swath simulate, KEY=VALUE")
given.add_argument("--option", action="append", default=[], help="option of terrain.forest, KEY=VALUE")
given = given.parse_args()
options = {"imu.file": "false", "gnss.file": "false", "world.length": "300 m", "world.width": "200 m", **dict(o.split("=", 1) for o in given.set)}
forest = {"type": "terrain.forest", **{k: float(v) if v.replace(".", "").isdigit() else v for k, v in (o.split("=", 1) for o in given.option)}}
rows, heights, diameters, sums = [], [], [], np.zeros(5, int)
for seed in given.seeds:
    folder = common.scratch("forest")
    survey = common.simulate(folder / "survey", seed=seed, world__scene=given.scene, **options)
    common.run([*STAGES, forest], survey / "survey.toml", folder / "products")
    with open(survey / "truth/trees.csv") as text:
        true = np.array([[float(r[k]) for k in ("x", "y", "height", "radius")] for r in csv.DictReader(text)])
    with open(folder / "products/trees.csv") as text:
        found = np.array([[float(r[k]) for k in ("x", "y", "height", "crown_diameter")] for r in csv.DictReader(text)])
    away = np.hypot(true[:, None, 0] - true[None, :, 0], true[:, None, 1] - true[None, :, 1])
    covered = np.any((away < true[None, :, 3]) & (true[None, :, 2] > true[:, None, 2]), axis=1)
    low, high = true[:, :2].min(0) + EDGE, true[:, :2].max(0) - EDGE
    d = np.hypot(found[:, None, 0] - true[None, :, 0], found[:, None, 1] - true[None, :, 1]) / true[None, :, 3]
    taken, right = {}, 0
    for k in np.argsort(-found[:, 2]):  # the highest top first, the nearest tree in its own radii
        j = min((j for j in np.argsort(d[k])[:5] if j not in taken), key=lambda j: d[k, j], default=None)
        if j is not None and d[k, j] < 1.0:
            taken[j] = k
    inside = lambda p: np.all((p[:, :2] > low) & (p[:, :2] < high), axis=1)
    own = np.nonzero(inside(true) & ~covered)[0]
    got = [j for j in own if j in taken]
    invented = sum(1 for k in np.nonzero(inside(found))[0] if k not in taken.values())
    h = np.array([found[taken[j], 2] - true[j, 2] for j in got])
    c = np.array([found[taken[j], 3] / (2 * true[j, 3]) - 1 for j in got])
    heights.append(h)
    diameters.append(c)
    numbers = [len(own), len(got), invented, int(np.sum(inside(true) & covered)), int(inside(found).sum())]
    sums += numbers
    rows.append([seed, *numbers, f"{np.median(h):.2f}", f"{common.rms(h):.2f}", f"{100 * np.median(c):.0f}"])
h, c = np.concatenate(heights), np.concatenate(diameters)
rows.append(["all", *sums, f"{np.median(h):.2f}", f"{common.rms(h):.2f}", f"{100 * np.median(c):.0f}"])
common.table(["seed", "trees", "found", "invented", "covered trees", "tops", "height, median m", "rms m", "crown diameter, median %"], rows)
