#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""How long a run takes on 1 to 1000 workers, on paper: a list of tasks, its processor times scaled to larger surveys, given out wave by wave.

    swath tasks configs/survey_sbet.toml --survey demo/survey.toml --output out --parts 8 --save tasks.json
    python3 bench/scale/schedule.py tasks.json --returns 1e9 1e10 --workers 1 10 100 1000

Each worker has one thread and takes the next task of a wave as soon as it is free; a wave begins when all tasks of the wave before are done. Shared waves have
--per-worker tasks for each worker. Times of tasks scatter log-normally by --spread; --start is what a process takes before it works; --fixed NAME=SECONDS is the time
of a task that is not shared and does not go with the returns (survey, the trajectory), --scale NAME=FACTOR corrects an expected time by a measured one.
Prints wall time, the share of it that a single process works alone, and efficiency: processor time / (workers x wall time), the critical path and its share."""
import argparse
import heapq
import json
import math
import random


def pairs(words):
    return {name: float(value) for name, _, value in (w.partition("=") for w in words)}


def wave_time(seconds, tasks, workers, args, rng):
    """List scheduling of one shared wave."""
    parts = [rng.lognormvariate(-0.5 * args.spread**2, args.spread) for _ in range(tasks)]
    scale = seconds / sum(parts)
    free = [0.0] * workers
    for part in parts:
        heapq.heapreplace(free, free[0] + args.start + part * scale)
    return max(free), max(parts) * scale + args.start


def simulate(waves, workers, args):
    rng = random.Random(args.seed)
    wall = busy = alone = critical = 0.0
    for wave in waves:
        tasks = args.per_worker * workers if wave["shared"] else 1
        if wave["shared"]:
            took, longest = wave_time(wave["seconds"], tasks, min(workers, tasks), args, rng)
        else:
            took = longest = args.start + wave["seconds"]
            alone += took
        wall, critical, busy = wall + took, critical + longest, busy + wave["seconds"]
    return {"wall": wall, "alone": alone / wall, "efficiency": busy / (workers * wall), "critical": critical / wall}


def waves_of(graph, returns, args):
    """Processor time of each wave for so many returns."""
    fixed, factors, out = pairs(args.fixed), pairs(args.scale), []
    for number in sorted({t["wave"] for t in graph["tasks"]}):
        tasks = [t for t in graph["tasks"] if t["wave"] == number]
        name = tasks[0]["stage"] or tasks[0]["grain"]
        seconds = sum(t["seconds"] for t in tasks) * returns / graph["returns"] * factors.get(name, 1.0)
        out.append({"name": name, "seconds": fixed.get(name, seconds), "shared": tasks[0]["grain"] in ("strip", "tile")})
    return out


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tasks", help="list of tasks with at least one return")
    parser.add_argument("--returns", type=float, nargs="+", default=[1e7, 1e8, 1e9, 1e10, 1e11])
    parser.add_argument("--workers", type=int, nargs="+", default=[1, 10, 100, 1000])
    parser.add_argument("--per-worker", type=int, default=4, help="tasks of a shared wave for each worker")
    parser.add_argument("--spread", type=float, default=0.3, help="standard deviation of the logarithm of a task's time")
    parser.add_argument("--start", type=float, default=0.5, help="seconds of each task before it works")
    parser.add_argument("--fixed", nargs="*", default=[], metavar="NAME=SECONDS")
    parser.add_argument("--scale", nargs="*", default=[], metavar="NAME=FACTOR")
    parser.add_argument("--seed", type=int, default=1)
    args = parser.parse_args()
    graph = json.loads(open(args.tasks, encoding="utf-8").read())
    if not graph["returns"]:
        parser.error(f"{args.tasks}: a survey without returns has no times to scale")
    print("| returns | processor time, h | workers | wall time, h | one process alone | efficiency | critical path / wall |\n|---|---|---|---|---|---|---|")
    for returns in args.returns:
        waves = waves_of(graph, returns, args)
        total = math.fsum(w["seconds"] for w in waves) / 3600
        for workers in args.workers:
            r = simulate(waves, workers, args)
            print(f"| {returns:.0e} | {total:.3g} | {workers} | {r['wall'] / 3600:.3g} | {100 * r['alone']:.0f} % | {r['efficiency']:.2f} | {r['critical']:.2f} |")


if __name__ == "__main__":
    main()
