#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What each stage costs, from finished runs: costs.py OUT [OUT ...] [--tasks TASKS.json]

Processor time per million returns of every stage that works on returns, from the report.json of each OUT, and of the run what no stage is charged with
(writing and reading the store of points, checksums, delivery). Several runs of different sizes show whether a cost grows with the size. With
`swath tasks CONFIG ... --save TASKS.json` of the last OUT: expected over measured processor time of the whole run.

    swath simulate survey --set world.scene=hills --set world.length="2 km" --set world.width="1 km"
    swath run survey_sbet --survey survey/survey.toml -o out && python3 bench/scale/costs.py out"""
import argparse
import json
from pathlib import Path


def costs(out):
    """Returns, seconds by stage, seconds of the run."""
    report = json.loads((Path(out) / "report.json").read_text())
    if report["pieces_resumed"]:
        raise SystemExit(f"{out}: parts of the run were done before, so their times are not of one run")
    returns = max(s["counts"]["in"] for s in report["stages"] if "counts" in s)
    return returns, {s["type"]: s["processor_seconds"] for s in report["stages"]}, report["processor_seconds"], report["seconds"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", nargs="+", help="folder of products")
    parser.add_argument("--tasks", help="list of tasks of the last of them")
    args = parser.parse_args()
    runs = [costs(out) for out in args.out]
    print("| stage | " + " | ".join(f"{returns / 1e6:.1f} M returns" for returns, *_ in runs) + " |")
    print("|---" * (1 + len(runs)) + "|")
    names = list(dict.fromkeys(name for _, stages, *_ in runs for name in stages))
    for name in names:
        print(f"| `{name}` | " + " | ".join(f"{1e6 * s[name] / n:.2f}" if name in s else "" for n, s, *_ in runs) + " |")
    print("| not of a stage | " + " | ".join(f"{1e6 * (whole - sum(s.values())) / n:.2f}" for n, s, whole, _ in runs) + " |")
    print("| together, s per million returns | " + " | ".join(f"{1e6 * whole / n:.2f}" for n, _, whole, _ in runs) + " |")
    print("| returns per second, wall time | " + " | ".join(f"{n / wall:,.0f}" for n, _, _, wall in runs) + " |")
    if args.tasks:
        expected = json.loads(Path(args.tasks).read_text())["seconds"]
        print(f"\nexpected {expected:.1f} s of processor time, measured {runs[-1][2]:.1f}: {expected / runs[-1][2]:.2f}")


if __name__ == "__main__":
    main()
