# SPDX-License-Identifier: GPL-3.0-or-later
"""The coefficients of filters.ground's stated probability (`calibration` in filters/ground.cpp): a logistic regression of true ground on the chance
counted around a return and on its place (Platt 1999, "Probabilistic outputs for support vector machines"), over simulated zoos of many sensors.

    ground_calibration.py [--repeat]

Needs the program ground_evidence (cmake -DSWATH_BENCH=ON). Prints for each survey the true share of ground by stated probability, with the
coefficients of the surveys of all other sensors, and then the coefficients of all. --repeat: from the surveys of the last call.
"""
import subprocess
import sys

import numpy as np

import common
import ground

# Seeds other than those of docs/accuracy.md. PRF in kHz, height in m, noise of ranges in cm.
SURVEYS = {11: (60, 500, 2), 12: (60, 500, 2), 13: (20, 900, 2), 14: (100, 400, 1), 15: (50, 600, 3), 16: (20, 600, 2), 17: (100, 700, 1), 18: (50, 400, 3),
           19: (20, 900, 1), 20: (60, 500, 2), 21: (40, 500, 2), 22: (80, 500, 2), 23: (30, 900, 2), 24: (100, 400, 1), 25: (60, 700, 2), 26: (20, 900, 2)}
COLUMNS = ("chance", "above", "spread", "lowered", "narrowed", "slope", "standing", "sunken", "support")
EVERY = 20           # of returns that no probability is in doubt of
LOG_ODDS = (-3, 4)   # of the chance: those in the regression; the many beyond would decide it alone
RIDGE = 1e-4


def evidence(survey, folder):
    """Returns of a survey as filters.ground sees them, with the truth."""
    output = common.scratch(f"{folder}/run") / "out"
    common.run([*ground.GEOREFERENCE, {"type": "writers.las", "compress": False, "scale": 0.0001}], survey.folder / "survey.toml", output)
    points = common.points_of(output)
    order = common.paired(points, survey.truth["t"] - 1e9, survey.truth["rn"])
    rows = np.stack([points[name][order] for name in ("x", "y", "z", "return_number", "number_of_returns", "point_source_id")], axis=1).astype("<f8")
    program = common.program().parents[1] / "bench/ground_evidence"
    done = subprocess.run([program], input=rows.tobytes(), stdout=subprocess.PIPE, check=True)
    seen = dict(zip(COLUMNS, np.frombuffer(done.stdout, "<f4").reshape(-1, len(COLUMNS)).T.astype(float)))
    # The lake's returns look like ground by every measure there is; breaks of the water's edge are not theirs.
    judged = np.isfinite(seen["above"]) & (survey.return_cover != 6) & (survey.kind != 9)
    seen = {name: column[judged] for name, column in seen.items()}
    return features(seen), survey.kind[judged] == 2, weights(seen)


def features(e):
    """As in filters/ground.cpp."""
    p = np.clip(e["chance"], 1e-4, 1 - 1e-4)
    return np.stack([np.ones(len(p)), np.log(p / (1 - p)), np.log(e["standing"] + 0.01)], axis=1)


def weights(e):
    """Returns that stand for others: doubtful ones for themselves, one of EVERY of the rest for all of them."""
    over = e["above"] + e["lowered"]
    doubtful = ((e["chance"] > 0.02) & (e["chance"] < 0.99)) | ((np.abs(over) > 2 * e["narrowed"]) & (over > -1) & (over < 0.7)) | (e["lowered"] > 0)
    return np.where(doubtful, 1, np.where(np.random.default_rng(1).random(len(over)) < 1 / EVERY, EVERY, 0))


def fitted(surveys):
    """Coefficients by iterated weighted least squares, every survey with the same weight."""
    parts = []
    for x, ground_is, _ in surveys:
        rows = (x[:, 1] > LOG_ODDS[0]) & (x[:, 1] < LOG_ODDS[1])
        parts.append((x[rows], ground_is[rows], np.full(rows.sum(), 1 / rows.sum())))
    x, y, w = (np.concatenate(p) for p in zip(*parts))
    w = w / w.sum()
    scale = np.maximum(x.std(axis=0), 1e-9)
    scale[0] = 1
    x, b = x / scale, np.zeros(x.shape[1])
    for _ in range(30):
        p = probability(x, b)
        r = w * p * (1 - p)
        lead = RIDGE * r.mean()
        step = np.linalg.solve((x * r[:, None]).T @ x + lead * np.eye(len(b)), x.T @ (w * (y - p)) - lead * b)
        b += step * min(1, 3 / np.abs(step).max())
    return b / scale


def probability(x, b):
    return 1 / (1 + np.exp(-np.clip(x @ b, -30, 30)))


def shares(p, ground_is, w):
    decile = np.minimum((10 * p).astype(int), 9)
    cells = []
    for k in range(10):
        here = (decile == k) & (w > 0)
        cells.append(f"{100 * np.average(p[here], weights=w[here]):.0f} / {100 * np.average(ground_is[here], weights=w[here]):.0f} ({w[here].sum()})" if here.any() else "-")
    return cells


def main():
    kept = common.SCRATCH / "ground_calibration"
    if "--repeat" not in sys.argv:
        common.scratch("ground_calibration")
        for seed, (prf, height, noise) in SURVEYS.items():
            options = {"scanner.prf": f"{prf} kHz", "flight.height": f"{height} m", "noise.range": f"{noise} cm"}
            survey = ground.Survey(common.scratch("ground_calibration/survey"), seed, "zoo", options)
            x, ground_is, w = evidence(survey, "ground_calibration")
            np.savez(kept / f"{seed}.npz", x=x[w > 0], ground=ground_is[w > 0], w=w[w > 0])
            print(f"seed {seed}: {len(x)} returns", file=sys.stderr, flush=True)
    surveys = {}
    for seed in SURVEYS:
        with np.load(kept / f"{seed}.npz") as file:
            surveys[seed] = file["x"], file["ground"], file["w"]
    rows, left_out = [], []
    for seed, (x, ground_is, w) in surveys.items():
        b = fitted([s for other, s in surveys.items() if SURVEYS[other] != SURVEYS[seed]])
        left_out.append((probability(x, b), ground_is, w))
        rows.append([seed, "%d kHz, %d m, %d cm" % SURVEYS[seed], *shares(*left_out[-1])])
    rows.append(["all", "", *shares(*(np.concatenate(part) for part in zip(*left_out)))])
    common.table(["seed", "sensor", *(f"{k / 10:.1f}-{(k + 1) / 10:.1f}" for k in range(10))], rows)
    print("calibration{" + ", ".join(f"{v:.3f}" for v in fitted(list(surveys.values()))) + "}")


if __name__ == "__main__":
    main()
