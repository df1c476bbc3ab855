#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Time, memory and errors of calib.strips by the number of flight lines: strips_size.py [LINES ...] [--set KEY=VALUE ...]

For each number of LINES (10 20 50 where none is given) a survey of lines of 200 s at 50 m/s and one across per 40, 136 m above an airfield, half of each
swath on the next line's, a sparse laser of 2 kHz (0.4 pulses per m2 of a line, 400,000 a line) and a delivered trajectory whose lines are off by shifts
and drifts of 8 and 6 cm and 0.01 deg. --set is for the stage, as corrections.spacing="1 s".

Printed: knots' spacing, unknowns without the planes' own, planes, rounds of linearisation; wall time, processor time and peak resident memory of the run
(calib.strips alone); what the lines differ by on planes before and after; rms errors of the corrected trajectory and the rms of errors over sigmas; the
exponents by which processor time and memory grew."""
import argparse
import json
import math
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "accuracy"))
import common
import navigation
import strips

SCRATCH = common.SCRATCH / "strips_size"
SURVEY = {"world.scene": "airfield", "world.length": "10 km", "flight.overlap": 0.5, "flight.height": "136 m", "flight.bank": "30 deg",
          "scanner.prf": "2 kHz", "scanner.frequency": "10 Hz", "mounting.deliver": "truth", "output.truth_returns": "false", "output.dtm_cell": "50 m",
          "imu.file": "false", "gnss.file": "false", **strips.DRIFTS}
STRIDE, LINES_OF_A_CROSS_LINE = 50, 40  # m; lines
STAGES = ("readers.trajectory", "readers.laser", "calib.strips", "writers.trajectory")


def simulate(lines):
    folder = SCRATCH / f"survey_{lines}"
    if not (folder / "truth/simulation.json").exists():
        common.call("simulate", folder, "--quiet", *common.sets({**SURVEY, "flight.lines": lines, "world.width": f"{max(200, STRIDE * lines)} m",
                                                                  "flight.cross_lines": -(-lines // LINES_OF_A_CROSS_LINE)}))
    return folder


def measure(lines, settings):
    survey, out, config = simulate(lines), SCRATCH / f"out_{lines}", SCRATCH / "strips.toml"
    shutil.rmtree(out, ignore_errors=True)
    config.write_text('[run]\nmemory = "2 GB"\n' + "".join(f'[[stage]]\ntype = "{s}"\n' for s in STAGES))
    begin = time.monotonic()
    child = subprocess.Popen([common.program(), "run", config, "--survey", survey / "survey.toml", "--output", out, "--quiet",
                              *(w for s in settings for w in ("--set", f"strips.{s}"))])
    _, status, usage = os.wait4(child.pid, 0)
    if status:
        sys.exit("the run failed")
    adjusted = json.loads((out / "strips.json").read_text())
    error, pull = strips.pulls(out, survey)
    if not os.environ.get("KEEP"):
        shutil.rmtree(survey)
        shutil.rmtree(out)
    return {"lines": lines, "adjusted": adjusted, "wall": time.monotonic() - begin, "processor": usage.ru_utime + usage.ru_stime,
            "memory": usage.ru_maxrss * 1024, "error": common.rms(error), "pull": common.rms(pull)}


def growth(a, b, key):
    return f"{math.log(b[key] / a[key]) / math.log(b['lines'] / a['lines']):.2f}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("lines", type=int, nargs="*", default=[10, 20, 50])
    parser.add_argument("--set", action="append", default=[], help="further option of the stage")
    args = parser.parse_args()
    SCRATCH.mkdir(parents=True, exist_ok=True)
    print("| lines | knots, s | unknowns | planes | linearisations | wall, s | processor, s | peak memory, GB | lines apart, cm | N E D cm; roll pitch heading arcsec "
          "| error/sigma | processor time grew to the power of | memory |")
    print("|---" * 13 + "|")
    before = None
    for lines in args.lines:
        now = measure(lines, args.set)
        a, apart = now["adjusted"]["adjustment"], now["adjusted"]["plane_differences"]["all"]
        planes = sum(k["planes"] for k in now["adjusted"]["flight"]["planes"].values())
        errors = " ".join(f"{100 * v:.1f}" for v in now["error"][:3]) + "; " + " ".join(f"{v / navigation.ARCSEC:.1f}" for v in now["error"][3:])
        grew = [growth(before, now, "processor"), growth(before, now, "memory")] if before else ["", ""]
        print("| " + " | ".join(map(str, [lines, f"{a['knot_spacing']:.1f}", a["unknowns"] - 3 * planes, planes, a["iterations"], f"{now['wall']:.0f}",
                                          f"{now['processor']:.0f}", f"{now['memory'] / 1e9:.2f}",
                                          f"{100 * apart['rms_before']:.1f} to {100 * apart['rms_after']:.1f}", errors,
                                          " ".join(f"{v:.2f}" for v in now["pull"]), *grew])) + " |", flush=True)
        for finding in now["adjusted"]["findings"]:
            print(f"- {lines}: {finding}")
        before = now


if __name__ == "__main__":
    main()
