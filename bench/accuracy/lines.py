# SPDX-License-Identifier: GPL-3.0-or-later
"""Clouds without their trajectory: what quality.lines finds of lines that lie apart, what filters.ground keeps of the ground between them, and how true
the terrain model's sigma is when the points carry none.

    lines.py [--seeds 4] [--first 11] [--parts shift sigma] [--settings NAME ...] [--set KEY=VALUE ...]

shift: every second line of a simulated zoo is raised by 5, 10 and 15 cm. sigma: lines with errors of their own; every survey is one draw of them.
"""
import argparse
import sys

import laspy
import numpy as np

import common
import ground

SIZE = {"world__length": "240 m", "world__width": "240 m", "imu__file": "false", "gnss__file": "false"}
SETTINGS = {"as simulated": {},
            "lines 5 cm apart": {"noise__line_shift": "5 cm"},
            "lines 5 cm apart, drift 3 cm": {"noise__line_shift": "5 cm", "noise__line_drift": "3 cm"},
            "range noise 5 cm": {"noise__range": "5 cm"},
            "a quarter of the density": {"scanner__prf": "25 kHz", "scanner__frequency": "30 Hz", "noise__line_shift": "5 cm"}}
COVERS = (1, 2, 3, 5)
CHAIN = [{"type": "readers.las"}, {"type": "quality.lines"}, {"type": "filters.ground"}]
FILES = [{"type": "writers.las", "compress": False, "scale": 0.0001}, {"type": "writers.gdal"}]


def cloud(survey, folder):
    """The survey's returns as a cloud of whoever: no sigmas, no ranges, no classes."""
    common.run([*ground.GEOREFERENCE, {"type": "writers.las", "compress": False, "scale": 0.0001}], survey.folder / "survey.toml", folder / "flown")
    text = 'name = "cloud"\ncrs = "EPSG:32632"\n'
    for k, file in enumerate(sorted((folder / "flown/points").glob("*.las"))):
        las = laspy.read(file)
        las.remove_extra_dims(list(las.point_format.extra_dimension_names))
        las.classification[:] = 0
        las.write(folder / f"{k}.las")
        text += f'[[points]]\nfile = "{k}.las"\ncrs = "EPSG:32632"\n'
    (folder / "survey.toml").write_text(text)
    return folder


def shifted(folder, to, shift):
    """Every second line raised."""
    for file in folder.glob("*.las"):
        las = laspy.read(file)
        las.z = np.asarray(las.z) + shift * (np.asarray(las.point_source_id) % 2)
        las.write(to / file.name)
    (to / "survey.toml").write_text((folder / "survey.toml").read_text())
    return to


def type_one(survey, chain, folder):
    """Error of labels, and what the stage found."""
    output = common.scratch("lines/run") / "out"
    report = common.run([*chain, FILES[0]], folder / "survey.toml", output)
    points = common.points_of(output)
    order = common.paired(points, survey.truth["t"] - 1e9, survey.truth["rn"])
    return common.agreement(survey.kind == 2, points["classification"][order] == 2), report


def judge_shift(given, options):
    rows = []
    for seed in range(given.first, given.first + given.seeds):
        survey = ground.Survey(common.scratch("lines/survey"), seed, "zoo", {**SIZE, **options})
        folder = cloud(survey, common.scratch("lines/cloud"))
        for shift in (0, 0.05, 0.10, 0.15):
            print(f"seed {seed}: {shift} m", file=sys.stderr, flush=True)
            moved = shifted(folder, common.scratch("lines/moved"), shift)
            for name, chain in {"compared": CHAIN, "not compared": [CHAIN[0], {**CHAIN[1], "least": 1000}, CHAIN[2]]}.items():
                errors, report = type_one(survey, chain, moved)
                found = common.stage_of(report, "quality.lines")["findings"]
                offsets = " ".join(f"{100 * line['offset_m']:+.1f}" for line in found["lines"])
                rows.append([seed, f"{100 * shift:.0f}", name, *common.cells(errors[:3]), offsets, "-" if found["residual_m"] is None else f"{1e3 * found['residual_m']:.0f}"])
    common.table(["seed", "shift cm", "lines", "type I %", "type II %", "total %", "offsets cm", "left mm"], rows)


def judge_sigma(given, options):
    rows = []
    for name in given.settings:
        setting = SETTINGS[name]
        found, scatter, shared, aside = ground.Found(), [], [], []
        for seed in range(given.first, given.first + given.seeds):
            print(f"{name}: seed {seed}", file=sys.stderr, flush=True)
            survey = ground.Survey(common.scratch("lines/survey"), seed, "zoo", {**SIZE, **setting, **options})
            folder = cloud(survey, common.scratch("lines/cloud"))
            output = common.scratch("lines/run") / "out"
            report = common.run([*CHAIN, {"type": "terrain.dtm"}, FILES[1]], folder / "survey.toml", output)
            lines = common.stage_of(report, "quality.lines")["findings"]
            scatter.append(lines["scatter_m"])
            shared.append(lines["common_m"])
            aside.append(lines.get("common_horizontal_m") or np.nan)
            ground.add_terrain(found, survey, output)
        found.join()
        for key in COVERS:
            here = (found.under == key) & (found.sigma > 0)
            ratio = found.error[here] / found.sigma[here]
            rows.append([name, ground.COVER[key], int(here.sum()), f"{1e3 * np.mean(scatter):.0f}", f"{1e3 * np.mean(shared):.0f}", f"{1e3 * np.nanmean(aside):.0f}",
                         f"{1e3 * common.rms(found.error[here]):.0f}", f"{1e3 * common.rms(found.sigma[here]):.0f}", f"{common.rms(ratio):.2f}",
                         f"{100 * np.mean(np.abs(ratio) < 1):.0f}", f"{100 * np.mean(np.abs(ratio) < 2):.0f}"])
    common.table(["survey", "cover", "cells", "scatter mm", "common mm", "aside mm", "rms mm", "sigma mm", "error/sigma", "within 1 sigma %", "within 2 %"], rows)


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--seeds", type=int, default=4)
    p.add_argument("--first", type=int, default=11)
    p.add_argument("--parts", nargs="*", default=["shift", "sigma"])
    p.add_argument("--settings", nargs="*", default=list(SETTINGS), choices=SETTINGS, help="of the part sigma")
    p.add_argument("--set", action="append", default=[], help="option of swath simulate, KEY=VALUE")
    given = p.parse_args()
    options = {k.replace(".", "__"): v for k, v in (o.split("=", 1) for o in given.set)}
    if "shift" in given.parts:
        judge_shift(given, options)
    if "sigma" in given.parts:
        judge_sigma(given, options)


if __name__ == "__main__":
    main()
