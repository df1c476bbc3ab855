# SPDX-License-Identifier: GPL-3.0-or-later
"""Errors over printed sigmas, per axis, over many small surveys whose trajectory and calibration errors are drawn anew: uncertainty.py [SURVEYS]"""
import sys

import numpy as np

import common

MAP = ("East", "North", "height")
KINDS = {
    "triangle, 350 m, mixed": {},
    "triangle, 1500 m, hills": {"flight.height": "1500 m", "world.scene": "hills"},
    "polygon, 120 m, town": {"flight.height": "120 m", "scanner.pattern": "polygon", "world.scene": "town", "scanner.half_angle": "35 deg"},
    "palmer, 600 m, steep": {"flight.height": "600 m", "scanner.pattern": "palmer", "world.scene": "steep"},
    "conical, 800 m, forest": {"flight.height": "800 m", "scanner.pattern": "conical", "world.scene": "forest", "scanner.half_angle": "15 deg"},
    "triangle, 700 m, all sigmas": {
        "flight.height": "700 m", "mounting.sigma.range_scale": 2e-5, "mounting.sigma.scan_offset": "0.002 deg", "mounting.sigma.latency": "0.5 ms",
        "scanner.divergence": "0.5 mrad", "noise.range": "3 cm", "noise.scan_angle": "0.003 deg"},
}
COMMON = {"world.length": "60 m", "world.width": "60 m", "flight.lines": 1, "flight.cross_lines": 0, "scanner.prf": "1500 Hz", "imu.file": "false",
          "gnss.file": "false", "output.dtm_cell": "100 m", "mounting.deliver": "drawn"}
STAGES = [{"type": "readers.trajectory"}, {"type": "readers.laser"}, {"type": "georeference"},
          {"type": "writers.las", "compress": False, "scale": 0.0001}]


def squares(kind, seed, folder):
    """Mean squares of error over sigma of one survey: east, north, up."""
    options = {**COMMON, **KINDS[kind], "seed": seed, "flight.direction": f"{seed * 37 % 360} deg"}
    survey = common.simulate(folder / "survey", **options)
    common.run(STAGES, survey / "survey.toml", folder / "out")
    truth = np.load(survey / "truth/returns.npy")
    points = common.points_of(folder / "out")
    order = common.paired(points, truth["t"] - 1e9, truth["rn"])
    good = ~np.isin(truth["cls"], common.OUTLIERS)
    error = common.errors_of(points, order, truth)[good]
    h, v = points["sigma_h"][order][good] / np.sqrt(2), points["sigma_v"][order][good]
    return np.mean(np.square(error / np.stack([h, h, v], axis=1)), axis=0)


def ratio(values):
    """Root of the mean over surveys, with its standard error."""
    values = np.asarray(values)
    mean = values.mean(axis=0)
    return np.sqrt(mean), values.std(axis=0, ddof=1) / np.sqrt(len(values)) / (2 * np.sqrt(mean))


def row(name, values):
    value, error = ratio(values)
    horizontal = ratio(np.asarray(values)[:, :2].mean(axis=1))
    return [name, len(values), *(f"{v:.3f} ± {e:.3f}" for v, e in zip(value, error)), f"{horizontal[0]:.3f} ± {horizontal[1]:.3f}"]


if __name__ == "__main__":
    surveys = int(sys.argv[1]) if len(sys.argv) > 1 else 60
    everything, rows = [], []
    for number, kind in enumerate(KINDS):
        values = []
        for i in range(surveys):
            values.append(squares(kind, 1000 * (number + 1) + i, common.scratch("uncertainty")))
        everything += values
        rows.append(row(kind, values))
    rows.append(row("all", everything))
    common.table(["surveys", "number", *MAP, "horizontal"], rows)
