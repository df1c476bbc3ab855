#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Plain mistakes of a user, one at a time, against the program: mistakes.py [--program PATH] [--json FILE] ...

One survey of two overlapping lines and a cross line is simulated. Each mistake of cases.py, trajectory_cases.py and navigation_cases.py is put into a copy
of its records, survey.toml or calibration, and two chains run on it: raw (IMU + GNSS, configs/survey.toml) and sbet (given trajectory,
configs/survey_sbet.toml). The truth is not named in the copies; errors of the points are measured here. Outcomes:

  refused   exit 1 or 2 with an error
  named     the run's geometry.named holds the mistake's identifier, or a message names the cause
  noted     a warning that the right survey's run does not have, or geometry.verdict "inconsistent", without the cause
  silent    exit 0 and nothing new: `harmless` where the points are as good as the right run's (1.5 times its error + 2 cm)
  crash, hang   a signal or an exit code of none of the program's; over --timeout

A refusal also counts as named where its message names the cause. --right N runs N right surveys of other scenes, scanners, overlaps,
heights, IMU grades and places and counts false alarms. The gate's share of the CPU is that of its stages in report.json. Needs NumPy.

  mistakes.py                        all mistakes, both chains (some 12 minutes), then the table and totals
  mistakes.py --only 'sbet|lever'    those whose name matches; --list lists them
  mistakes.py --right 40             right surveys alone
  mistakes.py --short                without terrain and pictures: a third of the time
"""
import argparse
import collections
import concurrent.futures
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tomllib

import numpy as np

import navigation_cases  # noqa: F401, adds its cases
import outcome
import right
import trajectory_cases  # noqa: F401, the same
from cases import CASES
from records import NotApplicable, Survey, toml_text

ROOT = pathlib.Path(__file__).resolve().parents[2]
CONFIGS = {"raw": "survey.toml", "sbet": "survey_sbet.toml"}
SURVEY = {"world.length": "400 m", "world.width": "300 m", "flight.lines": 2, "flight.cross_lines": 1, "scanner.prf": "6 kHz",
          "scanner.frequency": "15 Hz", "control.targets": 3, "control.points": 15}
GATE = "quality.geometry"
LEFT_OUT = ("filters.ground", "terrain.", "filters.hag_dem", "writers.gdal", "writers.picture", "report.truth")  # by --short


def arguments():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--program", type=pathlib.Path, default=pathlib.Path(os.environ.get("SWATH", ROOT / "build/release/tools/swath")))
    p.add_argument("--configs", type=pathlib.Path, default=ROOT / "configs", help="folder of survey.toml and survey_sbet.toml")
    p.add_argument("--scratch", type=pathlib.Path, default=pathlib.Path(os.environ.get("SWATH_SCRATCH", ROOT / "out")))
    p.add_argument("--scene", default="mixed")
    p.add_argument("--scanner", default="triangle", help="pattern of `swath simulate`")
    p.add_argument("--seed", type=int, default=1)
    p.add_argument("--chain", choices=CONFIGS, action="append")
    p.add_argument("--only", default="", help="regular expression of names")
    p.add_argument("--right", type=int, metavar="N", help="run N right surveys in place of the mistakes")
    p.add_argument("--first", type=int, default=0, help="number of the first right survey")
    p.add_argument("--set", action="append", default=[], help="option of every run, as of `swath run`")
    p.add_argument("--short", action="store_true")
    p.add_argument("--gate", action="store_true", help=f"put {GATE} behind readers.laser in configs without it")
    p.add_argument("--jobs", type=int, default=1)
    p.add_argument("--timeout", type=float, default=120.0, help="s, after which a run hangs")
    p.add_argument("--json", type=pathlib.Path, help="results, one record for each run")
    p.add_argument("--keep", action="store_true", help="keep surveys and products")
    p.add_argument("--list", action="store_true")
    return p.parse_args()


class Bench:
    def __init__(self, o):
        self.o = o
        self.scratch = o.scratch.resolve() / "mistakes"
        shutil.rmtree(self.scratch, ignore_errors=True)
        self.scratch.mkdir(parents=True)
        if not o.program.exists():
            sys.exit(f"{o.program} is missing: build it, or state --program")
        self.configs = {chain: self.config(chain) for chain in o.chain or CONFIGS}

    def config(self, chain):
        file = self.o.configs / CONFIGS[chain]
        if not self.o.short and not self.o.gate:
            return file
        tree = tomllib.loads(file.read_text())
        if self.o.short:
            tree["stage"] = [s for s in tree["stage"] if not s["type"].startswith(LEFT_OUT)]
        if self.o.gate and not any(s["type"] == GATE for s in tree["stage"]):
            behind = next(k for k, s in enumerate(tree["stage"]) if s["type"] == "readers.laser")
            tree["stage"].insert(behind + 1, {"type": GATE})
        short = self.scratch / file.name
        short.write_text(toml_text(tree))
        return short

    def simulate(self, name, options, may_fail=False):
        folder = self.scratch / name
        done = subprocess.run([self.o.program, "simulate", folder, "--quiet", *(w for k, v in options.items() for w in ("--set", f"{k}={v}"))],
                              text=True, stderr=subprocess.PIPE)
        if done.returncode and may_fail and "fly higher" in done.stderr:
            return None
        if done.returncode:
            sys.exit(f"swath simulate {options}: {done.stderr}")
        return folder

    def run(self, name, chain, survey, shift=0.0, truth=None):
        output = self.scratch / f"{name}.{chain}"
        done = outcome.run(self.o.program, self.configs[chain], survey, output, self.o.timeout, self.o.set)
        error = outcome.true_error(output, truth, shift) if truth is not None and done.code in (0, 3) else np.nan
        if not self.o.keep:
            shutil.rmtree(output, ignore_errors=True)
        return done, error


def judge(case, done, right_run, error, right_error):
    """Outcome, whether the cause is named, and the new messages."""
    messages = outcome.messages(done)
    new = [text for key, text in messages.items() if key not in outcome.messages(right_run)]
    gate = outcome.geometry(done.report)
    ids = outcome.identifiers(gate.get("named"))
    by_gate = bool(set(ids) & set(case.ids))
    # Messages of a gate that names another mistake count for nothing.
    heard = [text for key, text in outcome.messages(done, of_gate=by_gate or not ids).items() if text in new]
    named = by_gate or bool(case.cause and any(re.search(case.cause, text, re.I) for text in heard))
    inconsistent = gate.get("verdict") == "inconsistent" and outcome.geometry(right_run.report).get("verdict") != "inconsistent"
    if done.hung:
        result = "hang"
    elif done.code not in (0, 1, 2, 3):
        result = "crash"
    elif done.code in (1, 2):
        result = "refused"
    elif named:
        result = "named"
    elif new or inconsistent or done.code == 3:
        result = "noted"
    else:
        result = "harmless" if not case.other_crs and error <= 1.5 * right_error + 0.02 else "silent"
    return dict(outcome=result, named=named, gate_named=by_gate, wrong=bool(ids) and not by_gate, ids=ids, verdict=gate.get("verdict", ""),
                messages=new)


def mistakes(bench):
    o = bench.o
    options = {"seed": o.seed, "world.scene": o.scene, "scanner.pattern": o.scanner, "imu.file": "true", "gnss.file": "true", **SURVEY}
    if o.scene not in right.BUILT:
        options["control.targets"] = 0
    folder = bench.simulate("right", options)
    truth = np.load(folder / "truth/returns.npy")
    other = []

    def other_flight():
        if not other:
            other.append(bench.simulate("other", {**options, "seed": o.seed + 1, "flight.direction": "150 deg", "flight.height": "420 m"}))
        return other[0]

    def survey():
        s = Survey(folder)
        s.other = other_flight
        return s

    rights = {}
    for chain in bench.configs:
        rights[chain] = bench.run("right_run", chain, survey().save(bench.scratch / "right_copy"), truth=truth)
        done, error = rights[chain]
        if done.code:
            sys.exit(f"the right survey ends with {done.code}: {done.stderr}")
        print(f"right survey, {chain}: {error:.3f} m, {done.cpu:.1f} s CPU, gate {outcome.gate_seconds(done.report):.3f} s, "
              f"verdict {outcome.geometry(done.report).get('verdict', '-')}", flush=True)

    def one(case, chain):
        s = survey()
        try:
            case.edit(s)
        except NotApplicable:
            return None
        place = bench.scratch / f"survey.{case.name}.{chain}"
        done, error = bench.run(case.name, chain, s.save(place), case.shift, truth)
        if not o.keep:
            shutil.rmtree(place)
        record = dict(case=case.name, what=case.what, chain=chain, code=done.code, expected=case.ids, reason=case.reason,
                      error=error if not case.other_crs else np.nan,
                      seconds=done.seconds, cpu=done.cpu, gate=outcome.gate_seconds(done.report), **judge(case, done, rights[chain][0], error,
                                                                                                          rights[chain][1]))
        print(row(record), file=sys.stderr, flush=True)
        return record

    work = [(c, chain) for c in CASES if re.search(o.only, c.name) for chain in c.chains if chain in bench.configs]
    if any("other" in c.name for c, _ in work):
        other_flight()
    with concurrent.futures.ThreadPoolExecutor(o.jobs) as pool:
        return [r for r in pool.map(lambda w: one(*w), work) if r]


def row(r):
    said = " ".join(r["ids"]) or "; ".join(r["messages"])
    mark = "yes" if r["named"] else "WRONG" if r["wrong"] else "no" if r["outcome"] not in ("silent", "harmless") else ""
    error = f"{r['error']:.2f}" if np.isfinite(r["error"]) else "-"
    return f"| {r['what']} | {r['chain']} | {r['outcome']} | {mark} | {error} | {said.replace('swath: error: ', '')[:110].replace('|', '/')} |"


def table(records):
    print("\n| mistake | chain | outcome | cause named | error m | what it says |\n|---|---|---|---|---|---|")
    for r in records:
        print(row(r))
    print("\n| chain | runs | refused | named | noted | harmless | silent, with a reason | silent | crash or hang |\n|---|---|---|---|---|---|---|---|---|")
    for chain in CONFIGS:
        here = [r for r in records if r["chain"] == chain]
        count = lambda *names: sum(r["outcome"] in names for r in here)
        silent = [r for r in here if r["outcome"] == "silent"]
        print(f"| {chain} | {len(here)} | {count('refused')} | {count('named')} | {count('noted')} | {count('harmless')} | {sum(bool(r['reason']) for r in silent)} | "
              f"{sum(not r['reason'] for r in silent)} | {count('crash', 'hang')} |")
    geometric = [r for r in records if r["expected"] and not r["reason"] and r["outcome"] != "harmless"]
    named = sum(r["named"] for r in geometric)
    print(f"\ncause named: {named} of {len(geometric)} runs with a geometric mistake ({100 * named / max(len(geometric), 1):.0f} %), "
          f"named wrongly {sum(r['wrong'] and not r['named'] for r in geometric)}")
    print("\nsilent, because:")
    for r in records:
        if r["outcome"] == "silent":
            print(f"- {r['what']} ({r['chain']}, {r['error']:.2f} m): {r['reason'] or 'NO REASON'}")


def fly(bench, index):
    """Simulates right survey `index`, higher where the ground would reach up to the aircraft."""
    options = right.options(index)
    for _ in range(4):
        folder = bench.simulate(f"right_{index}", options, may_fail=True)
        if folder:
            return folder, options
        options["flight.height"] = f"{1.5 * float(options['flight.height'].split()[0]):.0f} m"
    sys.exit(f"right survey {index} cannot be flown: {options}")


def right_surveys(bench):
    records = []
    for index in range(bench.o.first, bench.o.first + bench.o.right):
        folder, options = fly(bench, index)
        truth = np.load(folder / "truth/returns.npy")
        survey = Survey(folder)
        for chain in bench.configs:
            done, error = bench.run(f"right_{index}", chain, survey.save(bench.scratch / f"right_copy_{index}"), truth=truth)
            gate = outcome.geometry(done.report)
            alarm = done.code == 3 or gate.get("verdict") == "inconsistent" or bool(outcome.identifiers(gate.get("named")))
            records.append(dict(index=index, chain=chain, code=done.code, alarm=alarm, verdict=gate.get("verdict", ""),
                                ids=outcome.identifiers(gate.get("named")),
                                error=error, cpu=done.cpu, gate=outcome.gate_seconds(done.report), stderr=done.stderr[-500:], returns=len(truth),
                                messages=outcome.messages(done), options=options))
            r = records[-1]
            print(f"| {index} | {chain} | {options['world.scene']} | {options['scanner.pattern']} | {options['flight.lines']} + {options['flight.cross_lines']} | "
                  f"{options['flight.height']} | {options['imu.grade']} | {len(truth)} | {error:.2f} | {done.code} | {r['verdict'] or '-'} | "
                  f"{'FALSE ALARM ' + ' '.join(r['ids']) if alarm else ''}{r['stderr'][:100]} |", flush=True)
        if not bench.o.keep:
            shutil.rmtree(folder)
            shutil.rmtree(bench.scratch / f"right_copy_{index}")
    print(f"\n{len(records)} runs of {bench.o.right} right surveys: {sum(r['alarm'] for r in records)} false alarms, "
          f"{sum(r['code'] not in (0, 3) for r in records)} did not end well; what they say:")
    for text, count in collections.Counter(text for r in records for text in r["messages"]).most_common():
        print(f"- {count} times: {text[:200]}")
    return records


def main():
    o = arguments()
    if o.list:
        for case in CASES:
            print(f"{case.name:28} {'+'.join(case.chains):9} {' '.join(case.ids):40} {case.what}")
        print(f"{len(CASES)} mistakes, {sum(len(c.chains) for c in CASES)} runs")
        return
    bench = Bench(o)
    if o.right:
        print("| survey | chain | scene | scanner | lines | height | IMU | returns | error m | exit | verdict | |\n|" + "---|" * 12)
        records = right_surveys(bench)
    else:
        records = mistakes(bench)
        table(records)
    cost, whole = sum(r["gate"] for r in records), sum(r["cpu"] for r in records if r["code"] in (0, 3))
    print(f"\ngate: {cost:.2f} s of {whole:.1f} s CPU of the runs that ended ({100 * cost / max(whole, 1e-9):.2f} %)")
    if o.json:
        o.json.write_text(json.dumps(records, indent=1, default=float))
    if not o.keep:
        shutil.rmtree(bench.scratch)


if __name__ == "__main__":
    main()
