# SPDX-License-Identifier: GPL-3.0-or-later
"""Classes of simulated surveys with outliers against truth: recall and precision of each, and what noise the filters find. Sums over the seeds.

    classes.py [--seeds 1 ...] [--scene mixed] [--without filters.outlier ...] [--set KEY=VALUE ...]
"""
import argparse

import numpy as np

import common

NAMES = {1: "unassigned", 2: "ground", 3: "low vegetation", 4: "medium vegetation", 5: "high vegetation", 6: "building", 7: "low noise", 9: "water",
         14: "wire", 15: "tower", 17: "bridge deck", 18: "high noise"}
STAGES = [{"type": "readers.trajectory"}, {"type": "readers.laser"}, {"type": "georeference"}, {"type": "filters.returns"}, {"type": "filters.noise", "neighbours": 2},
          {"type": "filters.outlier"}, {"type": "filters.ground"}, {"type": "filters.water"}, {"type": "filters.visibility"},
          {"type": "terrain.dtm", "classes": [2, 9]}, {"type": "filters.hag_dem"},
          {"type": "filters.classify", "medium_vegetation": "2 m", "high_vegetation": "5 m"},  # the simulation's limits
          {"type": "writers.las", "compress": False}]

given = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
given.add_argument("--seeds", type=int, nargs="+", default=[1])
given.add_argument("--scene", default="mixed")
given.add_argument("--without", nargs="*", default=[], help="stages left out")
given.add_argument("--set", action="append", default=[], help="option of swath simulate, KEY=VALUE")
given = given.parse_args()
options = {"imu.file": "false", "gnss.file": "false", **dict(o.split("=", 1) for o in given.set)}
stages = [s for s in STAGES if s["type"] not in given.without]
said, true = [], []
for seed in given.seeds:
    folder = common.scratch("classes")
    survey = common.simulate(folder / "survey", seed=seed, world__scene=given.scene, **options)
    report = common.run(stages, survey / "survey.toml", folder / "products")
    truth = np.load(survey / "truth/returns.npy")
    points = common.points_of(folder / "products")
    order = common.paired(points, truth["t"] - 1e9, truth["rn"])
    said.append(points["classification"][order].astype(int))
    true.append(truth["cls"].astype(int))
said, true = np.concatenate(said), np.concatenate(true)
rows = []
for kind in sorted(set(np.unique(true)) | set(np.unique(said))):
    both = np.sum((said == kind) & (true == kind))
    n_true, n_said = np.sum(true == kind), np.sum(said == kind)
    wrong = np.bincount(said[(true == kind) & (said != kind)], minlength=32) if n_true else np.zeros(32, int)
    worst = ", ".join(f"{NAMES.get(int(k), int(k))} {wrong[k]}" for k in np.argsort(-wrong)[:2] if wrong[k])
    rows.append([kind, NAMES.get(kind, ""), n_true, n_said, f"{100 * both / n_true:.2f}" if n_true else "", f"{100 * both / n_said:.2f}" if n_said else "", worst])
common.table(["class", "", "returns", "said", "recall %", "precision %", "mostly taken for"], rows)
common.table(["stage", "points/s of thread time", "tally"], [[s["type"], f"{s['counts']['in'] / max(s['seconds'], 1e-9):.0f}" if "counts" in s else "",
              "; ".join(f"{k}: {v['count']}" for k, v in s.get("tally", {}).items())] for s in report["stages"] if s["type"].startswith(("filters.", "terrain."))])
