# SPDX-License-Identifier: GPL-3.0-or-later
"""Classes of a simulated mixed survey with outliers against truth: recall and precision of each, and what noise the filters find."""
import sys

import numpy as np

import common

NAMES = {1: "unassigned", 2: "ground", 3: "low vegetation", 4: "medium vegetation", 5: "high vegetation", 6: "building", 7: "low noise", 9: "water",
         14: "wire", 15: "tower", 17: "bridge deck", 18: "high noise"}
STAGES = [{"type": "readers.trajectory"}, {"type": "readers.laser"}, {"type": "georeference"}, {"type": "filters.returns"}, {"type": "filters.noise", "neighbours": 2},
          {"type": "filters.outlier"}, {"type": "filters.smrf"}, {"type": "filters.visibility"}, {"type": "terrain.dtm"}, {"type": "filters.hag_dem"},
          {"type": "filters.classify", "medium_vegetation": "2 m", "high_vegetation": "5 m"},  # the simulation's limits
          {"type": "writers.las", "compress": False}]

folder = common.scratch("classes")
seed = int(sys.argv[1]) if len(sys.argv) > 1 else 1
only = sys.argv[2].split(",") if len(sys.argv) > 2 else []  # stages left out
survey = common.simulate(folder / "survey", seed=seed, world__scene="mixed", imu__file="false", gnss__file="false")
stages = [s for s in STAGES if s["type"] not in only]
report = common.run(stages, survey / "survey.toml", folder / "products")
truth = np.load(survey / "truth/returns.npy")
points = common.points_of(folder / "products")
order = common.paired(points, truth["t"] - 1e9, truth["rn"])
said, true = points["classification"][order].astype(int), truth["cls"].astype(int)
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
