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
           19: (20, 900, 1), 20: (60, 500, 2), 21: (40, 500, 2), 22: (80, 500, 2), 23: (30, 900, 2), 24: (100, 400, 1), 25: (60, 700, 2), 26: (20, 900, 2),
           27: (150, 400, 1), 28: (200, 300, 1), 29: (100, 300, 1), 30: (120, 500, 2), 31: (200, 400, 2), 32: (150, 300, 1), 41: (60, 500, 2),
           42: (60, 500, 2), 43: (20, 900, 2), 44: (100, 400, 1), 45: (60, 500, 2), 46: (20, 900, 2), 47: (100, 400, 1), 48: (40, 600, 2),
           49: (80, 700, 2), 50: (150, 500, 2), 51: (200, 300, 2), 52: (30, 700, 1), 53: (50, 800, 3), 54: (120, 300, 1), 55: (60, 500, 2),
           56: (20, 900, 2), 57: (100, 400, 1), 58: (20, 500, 3)}
COLUMNS = ("chance", "above", "spread", "lowered", "narrowed", "slope", "standing", "sunken", "support", "over_lowest", "low_objects")
FITTED = 30000         # returns of a survey
FEWEST = 100           # returns of a decile whose distance counts
EVERY = 20             # of returns that no probability is in doubt of
DOUBT = (0.02, 0.98)   # probabilities in the regression: the many beyond would decide it alone
TRIMS = 4              # rounds, as the probability that is not known before decides what is in the regression
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
    return features(seen), seen["chance"], survey.kind[judged] == 2, weights(seen)


def features(e):
    """As in filters/ground.cpp; NaN where the chance itself is stated."""
    p = np.clip(e["chance"], 1e-4, 1 - 1e-4)
    over, returns, objects = e["above"] + e["lowered"], np.log(e["support"] + 1), np.log(e["low_objects"] + 0.003)
    x = np.stack([np.ones(len(p)), np.log(p / (1 - p)), np.log1p(e["over_lowest"] / 0.03), np.minimum(over, 1), np.log(e["standing"] + 0.01),
                  np.log(e["sunken"] + 0.01), returns, objects, returns * objects], axis=1)
    x[(over <= 0) | (e["chance"] < 1e-4)] = np.nan
    return x


def weights(e):
    """Returns that stand for others: doubtful ones for themselves, one of EVERY of the rest for all of them."""
    over = e["above"] + e["lowered"]
    doubtful = ((e["chance"] > 0.02) & (e["chance"] < 0.99)) | ((np.abs(over) > 2 * e["narrowed"]) & (over > -1) & (over < 0.7)) | (e["lowered"] > 0)
    doubtful |= (over > 0) & (e["chance"] > 1e-3) & (e["chance"] < 0.9999)
    return np.where(doubtful, 1, np.where(np.random.default_rng(1).random(len(over)) < 1 / EVERY, EVERY, 0))


def fitted(surveys):
    """Coefficients, every survey with the same weight."""
    parts = []
    for x, _, ground_is, w in surveys:
        rows = np.flatnonzero(np.isfinite(x[:, 0]))
        rows = np.random.default_rng(1).choice(rows, min(FITTED, len(rows)), replace=False)
        parts.append((x[rows], ground_is[rows], w[rows] / w[rows].sum()))
    x, y, w = (np.concatenate(p) for p in zip(*parts))
    x = x.astype(float)
    b = regression(x, y, w)
    for _ in range(TRIMS):
        p = probability(x, b)
        rows = (p > DOUBT[0]) & (p < DOUBT[1])
        b = regression(x[rows], y[rows], w[rows])
    return b


def regression(x, y, w):
    """Logistic, by iterated weighted least squares."""
    w = w / w.sum()
    middle, scale = np.average(x, axis=0, weights=w), np.maximum(x.std(axis=0), 1e-9)
    middle[0], scale[0] = 0, 1
    x, b = (x - middle) / scale, np.zeros(x.shape[1])
    for _ in range(30):
        p = probability(x, b)
        r = w * p * (1 - p)
        lead = RIDGE * r.mean()
        step = np.linalg.solve((x * r[:, None]).T @ x + lead * np.eye(len(b)), x.T @ (w * (y - p)) - lead * b)
        b += step * min(1, 3 / np.abs(step).max())
    b = b / scale
    b[0] -= middle @ b
    return b


def probability(x, b):
    return 1 / (1 + np.exp(-np.clip(x @ b, -30, 30)))


def stated(x, chance, b):
    return np.where(np.isnan(x[:, 0]), chance, probability(x, b))


def shares(p, ground_is, w):
    decile = np.minimum((10 * p).astype(int), 9)
    cells = []
    for k in range(10):
        here = (decile == k) & (w > 0)
        cells.append(f"{100 * np.average(p[here], weights=w[here]):.0f} / {100 * np.average(ground_is[here], weights=w[here]):.0f} ({w[here].sum():.0f})" if here.any() else "-")
    return cells


def distances(p, ground_is, w):
    """Of the deciles between 0.1 and 0.9 from the truth."""
    decile = np.minimum((10 * p).astype(int), 9)
    return [abs(np.average(p[here] - ground_is[here], weights=w[here])) for here in (decile == k for k in range(1, 9)) if w[here].sum() >= FEWEST]


def main():
    kept = common.SCRATCH / "ground_calibration"
    if "--repeat" not in sys.argv:
        common.scratch("ground_calibration")
        for seed, (prf, height, noise) in SURVEYS.items():
            options = {"scanner.prf": f"{prf} kHz", "flight.height": f"{height} m", "noise.range": f"{noise} cm"}
            survey = ground.Survey(common.scratch("ground_calibration/survey"), seed, "zoo", options)
            x, chance, ground_is, w = evidence(survey, "ground_calibration")
            np.savez(kept / f"{seed}.npz", x=x[w > 0].astype(np.float32), chance=chance[w > 0], ground=ground_is[w > 0], w=w[w > 0])
            print(f"seed {seed}: {len(x)} returns", file=sys.stderr, flush=True)
    surveys = {}
    for seed in SURVEYS:
        with np.load(kept / f"{seed}.npz") as file:
            surveys[seed] = file["x"], file["chance"], file["ground"], file["w"]
    rows, left_out, far = [], [], []
    without = {sensor: fitted([s for seed, s in surveys.items() if SURVEYS[seed] != sensor]) for sensor in set(SURVEYS.values())}
    for seed, (x, chance, ground_is, w) in surveys.items():
        left_out.append((stated(x, chance, without[SURVEYS[seed]]), ground_is, w))
        rows.append([seed, "%d kHz, %d m, %d cm" % SURVEYS[seed], *shares(*left_out[-1])])
        far += distances(*left_out[-1])
    rows.append(["all", "", *shares(*(np.concatenate(part) for part in zip(*left_out)))])
    common.table(["seed", "sensor", *(f"{k / 10:.1f}-{(k + 1) / 10:.1f}" for k in range(10))], rows)
    print(f"deciles 0.1 to 0.9 with {FEWEST} returns: {len(far)}, mean distance {100 * np.mean(far):.1f} points, within 5 points {np.sum(np.array(far) <= 0.05)}\n")
    print("calibration{" + ", ".join(f"{v:.4f}" for v in fitted(list(surveys.values()))) + "}")


if __name__ == "__main__":
    main()
