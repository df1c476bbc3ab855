#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Whose fault is a difference at a check point? Simulated surveys with nothing wrong, one bad mark, one shifted line, one wrong geoid.

  SWATH_PROGRAM=build/release/tools/swath python3 bench/accuracy/marks.py [--seeds 20]

Of each case: how many surveys name what is wrong, and how many name anything else. Wants numpy."""
import argparse
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import tomllib

import numpy

PROGRAM = os.environ.get("SWATH_PROGRAM", "build/release/tools/swath")
ROOT = pathlib.Path(__file__).resolve().parents[2]
OPTIONS = ["world.length=\"600 m\"", "world.width=\"400 m\"", "scanner.prf=\"12 kHz\"", "control.points=30", "imu.file=false", "gnss.file=false", "output.truth_returns=false"]
SCENES = ["hills", "town", "mixed", "steep", "forest"]
CONFIG = """
[[stage]]
type = "readers.trajectory"
[[stage]]
type = "readers.laser"
[[stage]]
type = "georeference"
[[stage]]
type = "filters.returns"
[[stage]]
type = "filters.noise"
[[stage]]
type = "filters.ground"
[[stage]]
type = "terrain.dtm"
cell = "1 m"
[[stage]]
type = "quality.points"
"""


def swath(*words):
    done = subprocess.run([PROGRAM, *map(str, words)], capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"{' '.join(map(str, words))}\n{done.stderr}")


def named(folder):
    """Codes with the mark or line that they name, and error / sigma of the marks' rms."""
    swath("run", folder / "points.toml", "--survey", folder / "survey.toml", "--output", folder / "out", "--quiet")
    stage = next(s for s in json.loads((folder / "out/report.json").read_text())["stages"] if s["type"] == "quality.points")
    return [(f["code"], f["sentence"]) for f in stage["findings"]["named"]], stage["findings"]


def marks_changed(folder, change):
    rows = (folder / "check.csv").read_text().splitlines()
    z = rows[0].split(",").index("z")
    out = [rows[0]]
    for k, row in enumerate(rows[1:]):
        cells = row.split(",")
        cells[z] = f"{float(cells[z]) + change(k):.4f}"
        out.append(",".join(cells))
    (folder / "check.csv").write_text("\n".join(out) + "\n")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--seeds", type=int, default=20)
    a = parser.parse_args()
    folder = pathlib.Path(os.environ.get("SWATH_SCRATCH", tempfile.gettempdir())) / "swath_marks"
    right = {"nothing wrong": 0, "bad mark": 0, "shifted line": 0, "wrong geoid": 0}
    false = dict.fromkeys(right, 0)
    for seed in range(1, a.seeds + 1):
        random = numpy.random.default_rng(seed)
        shutil.rmtree(folder, ignore_errors=True)
        swath("simulate", folder, "--quiet", "--set", f"seed={seed}", "--set", f"world.scene={SCENES[seed % len(SCENES)]}", *[w for o in OPTIONS for w in ("--set", o)])
        (folder / "points.toml").write_text(CONFIG)
        good = {name: (folder / name).read_bytes() for name in ("check.csv", "laser.npy")}
        survey = tomllib.loads((folder / "survey.toml").read_text())
        bad, by = int(random.integers(30)), float(random.choice([-1, 1]) * random.uniform(0.3, 0.8))
        line = survey["line"][int(random.integers(len(survey["line"])))]
        cases = {"nothing wrong": None, "bad mark": lambda: marks_changed(folder, lambda k: by if k == bad else 0.0),
                 "wrong geoid": lambda: marks_changed(folder, lambda k: -46.8)}

        def shift():
            shots = numpy.load(folder / "laser.npy")
            times = [float(str(line[key]).split()[0]) for key in ("start", "end")]
            field = next(n for n in shots.dtype.names if n in ("t", "time"))
            here = (shots[field] >= times[0]) & (shots[field] <= times[1])
            shots["range"][here] += by
            numpy.save(folder / "laser.npy", shots)
        cases["shifted line"] = shift
        for case, change in cases.items():
            for name, data in good.items():
                (folder / name).write_bytes(data)
            if change:
                change()
            found, findings = named(folder)
            if case == "nothing wrong":  # a mark under a house is not read
                bad = next(k for k in [*range(bad, 30), *range(bad)] if f"ground {k + 1}" not in findings.get("unread", []))
            wanted = {"nothing wrong": None, "bad mark": ("check.mark", f"ground {bad + 1} ("), "shifted line": ("check.line", f"line {line['id']} "), "wrong geoid": ("check.heights", "")}[case]
            hits = [f for f in found if wanted and f[0] == wanted[0] and wanted[1] in f[1]]
            right[case] += 1 if hits or not wanted and not found else 0
            false[case] += len(found) - len(hits)
            if len(found) != len(hits) or wanted and not hits:
                print(f"seed {seed}, {case} ({by:+.2f} m, mark {bad + 1}, line {line['id']}): {found}", flush=True)
    print(f"\n| case | surveys | named rightly | named besides |\n|---|---|---|---|")
    for case in right:
        print(f"| {case} | {a.seeds} | {right[case]} | {false[case]} |")
    shutil.rmtree(folder, ignore_errors=True)


if __name__ == "__main__":
    main()
