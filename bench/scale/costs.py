#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What each stage costs, from finished runs: costs.py stages OUT [OUT ...]
Processor time per million returns of every stage, from the report.json of each OUT, and of the run what no stage is charged with (writing and reading
the store of points, checksums, delivery). Several runs of different sizes show whether a cost grows with the size.

What the tasks of a run cost beside what `swath tasks` expects: costs.py waves CONFIG SURVEY OUT [--set KEY=VALUE ...]
Each wave is run by one process, whose processor time is taken from the system. Of the wave that finishes, what the stages before would merge again is
part.

    swath simulate survey --set world.scene=hills --set world.length="2 km" --set world.width="1 km"
    swath run survey_sbet --survey survey/survey.toml -o out && python3 bench/scale/costs.py stages out
    SWATH=swath python3 bench/scale/costs.py waves survey_sbet survey/survey.toml waves"""
import argparse
import json
import os
import subprocess
from pathlib import Path

SWATH = os.environ.get("SWATH", "swath")


def costs(out):
    """Returns, seconds by stage, seconds of the run."""
    report = json.loads((Path(out) / "report.json").read_text())
    if report["pieces_resumed"]:
        raise SystemExit(f"{out}: parts of the run were done before, so their times are not of one run")
    returns = max(s["counts"]["in"] for s in report["stages"] if "counts" in s)
    stages = {}
    for s in report["stages"]:
        stages[s["type"]] = stages.get(s["type"], 0.0) + s["processor_seconds"]
    return returns, stages, report["processor_seconds"], report["seconds"]


def print_stages(args):
    runs = [costs(out) for out in args.out]
    print("| stage | " + " | ".join(f"{returns / 1e6:.1f} M returns" for returns, *_ in runs) + " |")
    print("|---" * (1 + len(runs)) + "|")
    names = list(dict.fromkeys(name for _, stages, *_ in runs for name in stages))
    for name in names:
        print(f"| `{name}` | " + " | ".join(f"{1e6 * s[name] / n:.2f}" if name in s else "" for n, s, *_ in runs) + " |")
    print("| not of a stage | " + " | ".join(f"{1e6 * (whole - sum(s.values())) / n:.2f}" for n, s, whole, _ in runs) + " |")
    print("| together, s per million returns | " + " | ".join(f"{1e6 * whole / n:.2f}" for n, _, whole, _ in runs) + " |")
    print("| returns per second, wall time | " + " | ".join(f"{n / wall:,.0f}" for n, _, _, wall in runs) + " |")


def processor_time(words):
    child = subprocess.Popen([SWATH, *words])
    _, status, usage = os.wait4(child.pid, 0)
    if status:
        raise SystemExit(f"{' '.join(words)} failed")
    return usage.ru_utime + usage.ru_stime


def print_waves(args):
    out, plan = Path(args.out), [args.config, "--survey", args.survey, "--output", args.out, *(w for s in args.set for w in ("--set", s))]
    if out.exists() and any(out.iterdir()):
        raise SystemExit(f"{out} is not empty: what is done in it would not be measured")
    tasks = json.loads(subprocess.run([SWATH, "tasks", *plan, "--parts", "1", "--json"], check=True, capture_output=True, text=True).stdout)
    print(f"{tasks['returns'] / 1e6:.1f} M returns\n\n| wave | expected, s | measured, s | ratio |\n|---|---|---|---|")
    expected = measured = 0.0
    for task in tasks["tasks"]:
        took = processor_time(["run", *plan, "--wave", str(task["wave"]), "--part", "1/1", "--quiet", "--threads", "1"])
        expected, measured = expected + task["seconds"], measured + took
        print(f"| {task['id']} | {task['seconds']:.1f} | {took:.1f} | {task['seconds'] / took:.2f} |", flush=True)
    print(f"| together | {expected:.1f} | {measured:.1f} | {expected / measured:.2f} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(required=True)
    stages = commands.add_parser("stages")
    stages.add_argument("out", nargs="+", help="folder of products")
    stages.set_defaults(do=print_stages)
    waves = commands.add_parser("waves")
    waves.add_argument("config")
    waves.add_argument("survey")
    waves.add_argument("out", help="empty folder")
    waves.add_argument("--set", action="append", default=[])
    waves.set_defaults(do=print_waves)
    args = parser.parse_args()
    args.do(args)


if __name__ == "__main__":
    main()
