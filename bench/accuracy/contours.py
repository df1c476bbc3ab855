# SPDX-License-Identifier: GPL-3.0-or-later
"""Contours of the zoo from raw records, every vertex against the analytic terrain, by what covers the ground.

    contours.py [--seeds 1] [--filter filters.smrf] [--option KEY=VALUE ...]     options of the run, contours.tolerance="0.1 m" and the like
"""
import argparse

import numpy as np

import common
from ground import COVER, GEOREFERENCE, Survey

LEVEL = 0.02  # rise / run: on flatter ground a distance aside says nothing


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--seeds", type=int, nargs="+", default=[1])
    p.add_argument("--filter", default="filters.smrf")
    p.add_argument("--option", action="append", default=[])
    given = p.parse_args()
    options = dict(o.split("=", 1) for o in given.option)
    chain = [*GEOREFERENCE, {"type": "filters.noise"}, {"type": given.filter}, {"type": "terrain.dtm", "cell": "1 m"}, {"type": "terrain.contours"}, {"type": "writers.gdal"}]
    errors, slopes, covers, lines, shorts = [], [], [], 0, 0
    for seed in given.seeds:
        survey = Survey(common.scratch("contours/survey"), seed, "zoo", {}, cell="0.5 m")
        output = common.scratch("contours/run") / "out"
        common.run(chain, survey.folder / "survey.toml", output, **options)
        for level, line in common.lines_of(output / "contours.gpkg"):
            x, y = line[:, 0], line[:, 1]
            at = lambda dx, dy: common.bilinear(survey.terrain, survey.place, x + dx, y + dy)  # noqa: E731
            errors.append(at(0, 0) - level)
            slopes.append(np.hypot(at(0.5, 0) - at(-0.5, 0), at(0, 0.5) - at(0, -0.5)))
            covers.append(np.nan_to_num(common.nearest(np.where(survey.area, survey.cover, 0), survey.place, x, y)))
            lines += 1
            shorts += np.sum(np.hypot(np.diff(x), np.diff(y))) < 20
    e, slope, cover = (np.concatenate(part) for part in (errors, slopes, covers))
    print(f"{given.filter}: {lines} lines, {shorts} of them shorter than 20 m\n")
    rows = []
    for key, name in {-1: "all", **COVER}.items():
        here = np.isfinite(e + slope) & ((cover > 0) if key < 0 else (cover == key))
        if here.sum() < 10:
            continue
        mm, tilted = 1e3 * e[here], here & (slope > LEVEL)
        aside = np.abs(e[tilted]) / slope[tilted]
        rows.append([name, here.sum(), f"{mm.mean():+.0f}", f"{np.median(np.abs(mm)):.0f}", f"{common.rms(mm):.0f}", f"{np.quantile(np.abs(mm), 0.95):.0f}",
                     *([f"{np.median(aside):.2f}", f"{np.quantile(aside, 0.95):.2f}"] if len(aside) else ["-", "-"])])
    common.table(["cover", "vertices", "mean mm", "median abs mm", "rms mm", "95 % mm", "aside median m", "95 % m"], rows)


if __name__ == "__main__":
    main()
