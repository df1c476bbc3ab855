# SPDX-License-Identifier: GPL-3.0-or-later
"""From raw IMU, GNSS and events to oriented images, and on to a block, over seeds: errors over standard deviations of direct and of
integrated orientation.

    python3 bench/block/flights.py build/release/tools/swath 20 [strip|none|block] [true|false: factors on sigmas] [true|false: correlation]
"""
import csv
import json
import math
import subprocess
import sys
import tempfile
from pathlib import Path

from blocks import times, turn

FLIGHT = ["output.laser=false", "output.trajectory=none", "events.file=true", "events.interval=2.5 s", "camera.file=true", "world.scene=hills",
          "flight.lines=3", "flight.cross_lines=2", "camera.control=5", "camera.check=20", "camera.boresight_sigma=0 deg",
          "camera.lever_arm_sigma=0 m"]
BORESIGHT = (0.31, -0.22, 0.53)  # deg, of the simulation
RUN = """[[stage]]
type = "readers.imu"
[[stage]]
type = "readers.gnss"
[[stage]]
type = "trajectory.ins_gnss"
[[stage]]
type = "time.sync"
[[stage]]
type = "orientation.direct"
correlated_images = 30
"""


def call(*words):
    done = subprocess.run([str(w) for w in words], capture_output=True, text=True)
    if done.returncode:
        raise SystemExit(done.stderr)


def rows_of(file):
    with open(file) as f:
        return list(csv.DictReader(line for line in f if not line.startswith("#")))


def ned_r_body(row):
    r, p, h = (math.radians(float(row[k])) for k in ("roll", "pitch", "heading"))
    return times(turn(2, h), times(turn(1, p), turn(0, r)))


def transposed(m):
    return [[m[c][r] for c in range(3)] for r in range(3)]


BODY_R_CAMERA = times(times(turn(2, math.radians(BORESIGHT[2])), times(turn(1, math.radians(BORESIGHT[1])), turn(0, math.radians(BORESIGHT[0])))),
                      [[0, 1, 0], [1, 0, 0], [0, 0, -1]])


class Sums(dict):
    """Squares by kind and flight. What all images of a flight share, as a boresight, is one value and not as many as there are images, so
    that the spread of the flights' means says how many independent values a ratio rests on."""

    def begin(self):
        for flights in self.values():
            flights.append([0.0, 0.0, 0])

    def add(self, kind, over, squares, n):
        total = self.setdefault(kind, [[0.0, 0.0, 0]])[-1]
        total[0], total[1], total[2] = total[0] + over, total[1] + squares, total[2] + n

    def note(self, kind, error, sigma):
        self.add(kind, (error / sigma) ** 2, error**2, 1)

    def lines(self):
        for kind, flights in self.items():
            over, squares, n = (sum(f[k] for f in flights) for k in range(3))
            out = f"{kind}: rms {math.sqrt(squares / n):.3g}, over sigma {math.sqrt(over / n):.3f}"
            used = [f for f in flights if f[2]]
            spread = sum((f[0] - over / n * f[2]) ** 2 for f in used) * len(used) / max(1, len(used) - 1) / n**2
            if len(used) > 1 and spread > 0.0:
                independent = min(n, 2.0 * (over / n) ** 2 / spread)  # variance of a mean of squares of N(0, s): 2 s^4 / n
                out += f" +- {math.sqrt(over / n / (2.0 * independent)):.3f} of {n} ({independent:.0f} independent)"
            yield out


def compare(sums, kind, found, truth, of_camera, positions=True, known=0.0):
    """`of_camera`: the table's roll, pitch, heading are of a body whose boresight was adjusted; its matrix is compared then. `known`: a
    sigma of each angle, rad, whose error `of_camera` does not have."""
    true = {r["name"]: r for r in truth}
    for row in found:
        t = true[row["image"]]
        for k, axis in enumerate("xyz" if positions else ""):
            sums.note(f"{kind} {'plan' if k < 2 else 'height'}, m", float(row[axis]) - float(t[axis]), math.sqrt(float(row[f"c{k + 1}{k + 1}"])))
        body = ned_r_body(row)
        camera = times(body, of_camera)
        e = times(transposed(camera), times(ned_r_body(t), BODY_R_CAMERA))
        for k, angle in enumerate(((e[2][1] - e[1][2]) / 2, (e[0][2] - e[2][0]) / 2, (e[1][0] - e[0][1]) / 2)):
            sums.note(f"{kind} {'tilt' if k < 2 else 'heading'}, deg", math.degrees(angle), math.degrees(math.sqrt(float(row[f"c{k + 4}{k + 4}"]) - known**2)))


def block_config(flown, drift, found, correlation):
    text = (flown / "block.toml").read_text()
    out = []
    for line in text.splitlines():
        if line.startswith("antenna"):
            continue
        if line.startswith("drift"):
            line = f'drift = "{drift}"'
        if line.startswith("sigma_angle"):
            line = f'sigma_angle = "{found["sigma_tilt_deg"]} deg"'
        if line.startswith("sigma_heading"):
            line = f'sigma_heading = "{found["sigma_turn_deg"]} deg"'
        out.append(line.replace('file = "images.csv"', 'file = "run/images.csv"'))
        if line == "[images]" and correlation:
            out.append('correlation = "run/orientation_correlation.csv"')
    (flown / "integrated.toml").write_text("\n".join(out) + "\n")


def fly(program, seed, drift, components, correlation, sums):
    with tempfile.TemporaryDirectory() as made:
        flown = Path(made) / "flown"
        call(program, "simulate", flown, "--quiet", "--set", f"seed={seed}", *(w for s in FLIGHT for w in ("--set", s)))
        (Path(made) / "run.toml").write_text(RUN)
        call(program, "run", Path(made) / "run.toml", "--survey", flown / "survey.toml", "--output", flown / "run", "--quiet")
        truth = rows_of(flown / "truth" / "images.csv")
        compare(sums, "direct", rows_of(flown / "run" / "orientation_direct.csv"), truth, BODY_R_CAMERA)
        report = json.loads((flown / "run" / "report.json").read_text())
        block_config(flown, drift, next(s["findings"] for s in report["stages"] if s["type"] == "orientation.direct"), correlation == "true")
        call(program, "block", flown / "integrated.toml", "--output", flown / "out", "--set", "adjust.robust=false", "--set", f"adjust.components={components}")
        block = json.loads((flown / "out" / "block.json").read_text())
        values = {v["name"]: v for v in block["cameras"][0]["values"]}
        b = [math.radians(values[f"boresight_{k}"]["value"]) for k in ("roll", "pitch", "heading")]
        adjusted = times(times(turn(2, b[2]), times(turn(1, b[1]), turn(0, b[0]))), [[0, 1, 0], [1, 0, 0], [0, 0, -1]])
        compare(sums, "integrated", rows_of(flown / "out" / "orientation.csv"), truth, adjusted)
        for c in block["check"]:
            sums.add(f"check points {c['coordinate']}, m", c["over_sigma"] ** 2 * c["points"], c["rms_m"] ** 2 * c["points"], c["points"])
        for name, true in zip(("roll", "pitch", "heading"), BORESIGHT):
            v = values[f"boresight_{name}"]
            sums.note("boresight, deg", v["value"] - true, v["sigma"])
        for name, true in {"f": 50.21, "x0": 0.021, "y0": -0.034}.items():
            sums.note(f"camera {name}, mm", values[name]["value"] - true, values[name]["sigma"])


def main(program, number=20, drift="none", components="false", correlation="true"):
    sums = Sums()
    for seed in range(1, number + 1):
        sums.begin()
        fly(program, seed, drift, components, correlation, sums)
    print(*sums.lines(), sep="\n")


if __name__ == "__main__":
    main(sys.argv[1], *map(int, sys.argv[2:3]), *sys.argv[3:])
