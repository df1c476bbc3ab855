# SPDX-License-Identifier: GPL-3.0-or-later
"""The weights of filters/ground/ground_probability.cpp: a logistic regression on what filters.ground knows of the returns of simulated surveys (the zoo at several
densities and echo_scenes.py) and of labelled real clouds. Prints for each cloud the total error and the deciles with it in the fit and with its
family held out, then the weights.

    ground_calibration.py [--bare-earth]      needs the target ground_evidence of a build with SWATH_BENCH=ON
"""
import subprocess
import sys

import laspy
import numpy as np

import common
import echo_scenes
import ground

# Seeds other than those of docs/accuracy/ground.md, but for 2; options of swath simulate.
ZOO = {"zoo 2": (2, {}), "zoo 13": (13, {"scanner.prf": "20 kHz", "flight.height": "900 m"}), "zoo 21": (21, {"scanner.prf": "40 kHz"}),
       "zoo 16": (16, {"scanner.prf": "20 kHz", "flight.height": "600 m"})}
ISPRS = {f"ISPRS {sample}": f"isprs/samp{sample}-utm.las" for sample in (11, 21, 24, 41, 52, 54, 71)}
AHN = {"AHN3": "ahn3_delft/ahn3_cropped_1.laz"}
IGN = {"IGN 627760": "ign_lidarhd/test_data_77050_627760_LA93_IGN69.laz", "IGN 627755": "ign_lidarhd/test_data_77055_627755_LA93_IGN69.laz",
       "IGN farmland": "ign_lidarhd/las_with_several_extra_byte_bloc.laz", "IGN thinned": "ign_lidarhd/test_semis_2021_0382_6565_LA93_IGN69_cropped.laz"}
# How much a cloud counts: its returns in doubt share the number. For bare earth labels count only where the truth is known.
MOWN = {**dict.fromkeys(ISPRS, 5), **dict.fromkeys(AHN, 3), **dict.fromkeys(IGN, 2), **dict.fromkeys(ZOO, 0.8), "zoo 2": 3, **dict.fromkeys(echo_scenes.SCENES, 0.3)}
BARE_EARTH = {**dict.fromkeys(ISPRS, 0.3), **dict.fromkeys(AHN, 0), **dict.fromkeys(IGN, 0), **dict.fromkeys(ZOO, 1), "zoo 2": 3, **dict.fromkeys(echo_scenes.SCENES, 0.6)}
FAMILIES = [*([name] for name in ISPRS), list(AHN), list(IGN), list(ZOO), list(echo_scenes.SCENES)]
FAR = 3.0              # m from the surface: there is no ground beyond
DOUBTFUL, SURE = 9000, 1500   # returns of a cloud that are looked at
RIDGE = 3e-6


def evidence(rows):
    """Distance from the surface, chance, and the terms of each return."""
    program = common.program().parents[1] / "bench/ground_evidence"
    done = subprocess.run([program], input=rows.astype("<f8").tobytes(), stdout=subprocess.PIPE, check=True)
    seen = np.frombuffer(done.stdout, "<f4").reshape(len(rows), -1).astype(float)
    return seen[:, 0], seen[:, 1], seen[:, 3:]


def zoo(name):
    seed, options = ZOO[name]
    survey = ground.Survey(common.scratch("ground_calibration/survey"), seed, "zoo", options)
    output = common.scratch("ground_calibration/run") / "out"
    common.run([*ground.GEOREFERENCE, {"type": "writers.las", "compress": False, "scale": 0.0001}], survey.folder / "survey.toml", output)
    points = common.points_of(output)
    order = common.paired(points, survey.truth["t"] - 1e9, survey.truth["rn"])
    rows = np.stack([points[c][order] for c in ("x", "y", "z", "return_number", "number_of_returns", "point_source_id")], axis=1)
    # The lake's returns look like ground by every measure there is.
    return rows, survey.kind == 2, (survey.return_cover != 6) & (survey.kind != 9)


def real(file):
    las = laspy.read(common.reference(file))
    rows = np.stack([las.x, las.y, las.z, las.return_number, las.number_of_returns, las.point_source_id], axis=1)
    return rows, np.asarray(las.classification) == 2, np.ones(len(rows), bool)


def sampled(rows, is_ground, counts):
    """Terms, truth and weights of some returns; number of all, ground that is lost whatever the weights are."""
    above, chance, terms = evidence(rows)
    judged = counts & (np.abs(above) <= FAR) & (rows[:, 3] >= rows[:, 4])
    doubtful = judged & ((chance < 0.999) | (np.abs(above) > 0.1))
    random = np.random.default_rng(1)
    parts = []
    for group, limit in ((doubtful, DOUBTFUL), (judged & ~doubtful, SURE)):
        at = np.flatnonzero(group)
        some = at if len(at) <= limit else random.choice(at, limit, replace=False)
        parts.append((some, np.full(len(some), len(at) / max(1, len(some)))))
    at, weight = (np.concatenate(p) for p in zip(*parts))
    return terms[at], is_ground[at], weight, counts.sum(), np.sum(is_ground & counts & ~judged)


def probability(x, b):
    return 1 / (1 + np.exp(-np.clip(x @ b, -30, 30)))


def solved(x, y, w):
    scale = np.sqrt(np.average(x**2, axis=0, weights=w)) + 1e-9
    x, b, w = x / scale, np.zeros(x.shape[1]), w / w.sum()
    for _ in range(12):
        p = probability(x, b)
        curvature = (x * (w * p * (1 - p))[:, None]).T @ x + RIDGE * np.eye(len(b))
        step = np.linalg.solve(curvature, x.T @ (w * (y - p)) - RIDGE * b)
        b += step * min(1, 4 / np.abs(step).max())
    return b / scale


def fitted(clouds, importance):
    b = None
    for _ in range(3):
        parts = []
        for name, (x, y, w, *_) in clouds.items():
            p = probability(x, b) if b is not None else 0
            doubt = w.sum() if b is None else np.sum(w * 4 * p * (1 - p)) + np.sum(w * np.abs(p - y)) + 30
            if importance[name]:
                parts.append((x, y.astype(float), w * importance[name] / doubt))
        b = solved(*(np.concatenate(p) for p in zip(*parts)))
    return b


def judged(cloud, b):
    x, y, w, count, lost = cloud
    p = probability(x, b)
    decile = np.minimum((10 * p).astype(int), 9)
    shares = [f"{100 * np.average(p[decile == k], weights=w[decile == k]):.0f} / {100 * np.average(y[decile == k], weights=w[decile == k]):.0f}" if (decile == k).any() else "-"
              for k in range(10)]
    return [f"{100 * (np.sum(w * ((p >= 0.5) != y)) + lost) / count:.2f}", *shares]


def main():
    importance = BARE_EARTH if "--bare-earth" in sys.argv else MOWN
    clouds = {name: sampled(*real(file)) for name, file in {**ISPRS, **AHN, **IGN}.items()}
    clouds |= {name: sampled(*zoo(name)) for name in ZOO}
    clouds |= {name: sampled(rows, truth, np.ones(len(rows), bool)) for name in echo_scenes.SCENES for rows, truth in [echo_scenes.cloud(name)]}
    weights = fitted(clouds, importance)
    rows = []
    for family in FAMILIES:
        without = fitted({name: cloud for name, cloud in clouds.items() if name not in family}, importance)
        for name in family:
            rows += [[name, "in", *judged(clouds[name], weights)], [name, "held out", *judged(clouds[name], without)]]
    common.table(["cloud", "in the fit", "total %", *(f"{k / 10:.1f}-{(k + 1) / 10:.1f}" for k in range(10))], rows)
    print("weights{" + ", ".join(f"{v:.3f}" for v in weights) + "}")


if __name__ == "__main__":
    main()
