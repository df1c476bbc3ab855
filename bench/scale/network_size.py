#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Time and memory of calib.network by the number of flight lines: network_size.py [LINES ...] [--spacing SECONDS] [--planes N] [--set KEY=VALUE ...]

For each number of LINES (5 10 20 where none is given) a survey of lines of 200 s at 50 m/s and one across, 300 m above an airfield, half of each swath on
the next line's: MEMS IMU of 200 Hz, fixes of 1 Hz, a sparse laser of 5 kHz (0.46 pulses per m2 of a line, 1 million a line). Turns take another 110 s a
line. A line's records take 47 MB of disk and its products 30 MB; both go once they are measured, unless KEEP is set. 400 planes a line, or --planes in
all; instants 0.25 s apart, or --spacing.

Printed: instants, unknowns, planes, returns on them, linearisations; wall time, its parts by the progress (a line every 3 s), processor time and peak
resident memory of the whole process; the exponents by which processor time and memory grew from one survey to the next."""
import argparse
import json
import math
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SWATH = os.environ.get("SWATH", str(ROOT / "build/release/tools/swath"))
SCRATCH = Path(os.environ.get("SWATH_SCRATCH", ROOT / "out")) / "network_size"
SECONDS, SPEED, STRIDE = 200, 50, 110  # of a line; m/s; m from line to line
SURVEY = {"world.scene": "airfield", "world.length": f"{SECONDS * SPEED} m", "flight.overlap": 0.5, "flight.cross_lines": 1, "flight.height": "300 m",
          "flight.bank": "30 deg", "scanner.prf": "5 kHz", "scanner.frequency": "20 Hz", "imu.grade": "mems", "gnss.rate": "1 Hz",
          "mounting.deliver": "truth", "output.trajectory": "none", "output.truth_returns": "false", "output.dtm_cell": "20 m"}
STAGES = ("readers.imu", "readers.gnss", "readers.laser", "calib.network", "writers.trajectory")
PLANES_OF_A_LINE = 400


def sets(options):
    return [word for key, value in options.items() for word in ("--set", f"{key}={value}")]


def simulate(lines):
    folder = SCRATCH / f"survey_{lines}"
    if not (folder / "truth/simulation.json").exists():
        subprocess.run([os.environ.get("SWATH_SIMULATE", SWATH), "simulate", folder, "--quiet",
                        *sets({**SURVEY, "flight.lines": lines, "world.width": f"{STRIDE * lines} m"})], check=True)
    return folder


def watched(command):
    """Seconds of each part that the progress names, to 3 s; wall time, processor time and peak memory (bytes) of the process."""
    parts, begin, last = {}, time.monotonic(), None
    child = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
    for line in child.stderr:
        if not line.startswith("{"):
            sys.stderr.write(line)
            continue
        now, said = time.monotonic(), json.loads(line)
        part = said["stage"] if said.get("finished") or "now" not in said else said["now"].split(": ")[-1]
        parts[part] = parts.get(part, 0.0) + now - (last or begin)
        last = now
    _, status, usage = os.wait4(child.pid, 0)
    if status:
        sys.exit(f"{' '.join(map(str, command))} failed")
    return parts, time.monotonic() - begin, usage.ru_utime + usage.ru_stime, usage.ru_maxrss * 1024


def measure(lines, args):
    survey, out, config = simulate(lines), SCRATCH / f"out_{lines}", SCRATCH / "network.toml"
    shutil.rmtree(out, ignore_errors=True)
    config.write_text('[run]\nmemory = "2 GB"\n' + "".join(f'[[stage]]\ntype = "{s}"\n' for s in STAGES))
    planes = args.planes or PLANES_OF_A_LINE * lines
    options = sets({"network.planes.planes": planes, "network.sections": 0, "network.smoother.node_spacing": f"{args.spacing} s"})
    parts, wall, processor, memory = watched([SWATH, "run", config, "--survey", survey / "survey.toml", "--output", out, "--json-log", *options,
                                              *(w for s in args.set for w in ("--set", s))])
    found = json.loads((out / "network.json").read_text())
    if not os.environ.get("KEEP"):
        shutil.rmtree(survey)
        shutil.rmtree(out)
    return {"lines": lines, "found": found, "parts": parts, "wall": wall, "processor": processor, "memory": memory}


def growth(a, b, key):
    return f"{math.log(b[key] / a[key]) / math.log(b['lines'] / a['lines']):.2f}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("lines", type=int, nargs="*", default=[5, 10, 20])
    parser.add_argument("--planes", type=int, help="in all, in place of 400 a line")
    parser.add_argument("--spacing", type=float, default=0.25, help="of the instants, s")
    parser.add_argument("--set", action="append", default=[], help="further option of the run")
    args = parser.parse_args()
    SCRATCH.mkdir(parents=True, exist_ok=True)
    print("| lines | instants | unknowns | planes | returns on them | linearisations, rounds | wall, s | processor, s | peak memory, GB | processor time grew with lines to the power of | memory |")
    print("|---" * 11 + "|")
    before, parts = None, []
    for lines in args.lines:
        now = measure(lines, args)
        f = now["found"]
        grew = [growth(before, now, "processor"), growth(before, now, "memory")] if before else ["", ""]
        print("| " + " | ".join(map(str, [lines, f["instants"], f["unknowns"], f["planes"], f["tie_returns"], f"{f['iterations']}, {f['rounds']}",
                                          f"{now['wall']:.0f}", f"{now['processor']:.0f}", f"{now['memory'] / 1e9:.2f}", *grew])) + " |", flush=True)
        parts.append((lines, now["parts"]))
        before = now
    print("\nParts, s: " + "; ".join(f"{lines} lines: " + ", ".join(f"{name} {s:.0f}" for name, s in p.items()) for lines, p in parts))


if __name__ == "__main__":
    main()
