# SPDX-License-Identifier: GPL-3.0-or-later
"""Strip adjustment of simulated surveys against truth: strips.py [SEEDS [PART ...]]

Four lines and one across over halls, the calibration held at the truth. Parts: sbet (a delivered trajectory whose lines are off by shifts and
drifts, five roofs surveyed), free (the same without surveyed roofs), outage (MEMS and GNSS records with an outage over line 3, through
trajectory.ins_gnss), own (MEMS, held at the calibration that a MEMS calibration flight of the same mounting gave; $PRF is that flight's pulse
rate). Lines are compared on the true facets of truth/planes.csv, which the program does not see."""
import concurrent.futures
import csv
import json
import os
import shutil
import sys
import tomllib

import numpy as np

import common
import navigation

SURVEY = {"world.scene": "airfield", "world.length": "700 m", "world.width": "500 m", "flight.lines": 4, "flight.cross_lines": 1,
          "flight.overlap": 0.5, "flight.height": "500 m", "scanner.prf": "20 kHz", "scanner.frequency": "30 Hz", "mounting.deliver": "truth",
          "control.targets": 5, "control.points": 20, "output.truth_returns": "false"}
DRIFTS = {"noise.line_shift": "8 cm", "noise.line_drift": "6 cm", "noise.line_attitude": "0.01 deg", "noise.line_attitude_drift": "0.01 deg"}
GIVEN, SMOOTHED = ["readers.trajectory"], ["readers.imu", "readers.gnss", "trajectory.ins_gnss"]
PARTS = {
    "sbet": (DRIFTS | {"imu.file": "false", "gnss.file": "false"}, GIVEN),
    "free": (DRIFTS | {"imu.file": "false", "gnss.file": "false", "control.targets": 0}, GIVEN),
    "outage": ({"imu.grade": "mems", "output.trajectory": "none"}, SMOOTHED),
    "own": ({"imu.grade": "mems", "output.trajectory": "none", "mounting.deliver": "nominal", "output.truth_returns": "true"}, SMOOTHED),
}
CALIBRATION = {"flight.pattern": "calibration", "imu.grade": "mems", "control.roof": "true", "output.trajectory": "none",
               "output.truth_returns": "false"}
OUTAGE = ("line 3", 25.0, 60.0)  # begins so many seconds before that line, and lasts so long
EDGE, REACH, FEWEST = 1.0, 0.5, 30  # m from a facet's edges, m from its plane, returns of a line


def facets_of(survey):
    """Facets of roofs: outward normal and corners (n x 3)."""
    with open(survey / "truth/planes.csv", newline="") as file:
        for row in csv.DictReader(file):
            if row["kind"] != "wall":
                normal = np.array([float(row[f"normal_{axis}"]) for axis in ("east", "north", "up")])
                yield normal, np.array([[float(v) for v in corner.split()] for corner in row["corners"].split(";")])


def offsets(points, survey):
    """Mean distance of each line's returns from each true facet that it has seen: list of {line: m}, one for each facet."""
    xyz = np.stack([points[a] for a in "xyz"], axis=1)
    out = []
    for normal, corners in facets_of(survey):
        low, high = corners.min(axis=0) - REACH, corners.max(axis=0) + REACH
        near = np.flatnonzero(((xyz > low) & (xyz < high)).all(axis=1))
        from_plane = (xyz[near] - corners.mean(axis=0)) @ normal
        inside = np.abs(from_plane) < REACH
        turn = np.sign(np.cross(corners[1] - corners[0], corners[2] - corners[1]) @ normal)
        for a, b in zip(corners, np.roll(corners, -1, axis=0)):
            inward = np.cross(normal, b - a) * turn
            inside &= (xyz[near] - a) @ (inward / np.linalg.norm(inward)) > EDGE
        line = points["point_source_id"][near]
        here = {int(k): from_plane[inside & (line == k)] for k in np.unique(line[inside])}
        out.append({k: float(np.mean(v)) for k, v in here.items() if len(v) >= FEWEST})
    return out


def measured(facets):
    """Differences of all pairs of lines on facets, and all offsets, m."""
    differences = [one[a] - one[b] for one in facets for a in one for b in one if a < b]
    return np.array(differences), np.array([v for one in facets for v in one.values()])


def pulls(output, survey):
    """Errors of the corrected trajectory along the lines over their sigmas: n x 6."""
    flown, truth = navigation.sbet(output / "trajectory.sbet"), navigation.sbet(survey / "truth/sbet.out")
    time, error, inside = navigation.errors(flown, truth)
    spread = navigation.sigmas(output / "trajectory.smrmsg")[inside][:, [1, 2, 3, 7, 8, 9]]
    lines = json.loads((output / "strips.json").read_text())["flight"]["lines"]
    good = np.zeros(len(time), bool)
    for line in lines:
        good |= (time >= line["first"] % 604800) & (time <= line["last"] % 604800)
    return error[good], (error / spread)[good]


def calibrate(folder, seed):
    """A calibration flight through configs/calibrate.toml; the true mounting, as options of the survey that is flown with it."""
    flight = {**CALIBRATION, "seed": 1000 + seed, **({"scanner.prf": os.environ["PRF"]} if "PRF" in os.environ else {})}
    common.call("simulate", folder / "flight", "--quiet", *common.sets(flight))
    common.call("run", common.ROOT / "configs/calibrate.toml", "--survey", folder / "flight/survey.toml", "--output", folder / "calibration",
                "--quiet", *common.sets({"ins_gnss.plots": "[]"}))
    truth = json.loads((folder / "flight/truth/calibration.json").read_text())
    if not os.environ.get("KEEP"):
        shutil.rmtree(folder / "flight")
    return {f"mounting.truth.{key}": truth[key] for key in ("roll", "pitch", "heading", "range_offset", "scan_scale")}


def point_pulls(output, survey):
    """Errors of the points over their sigmas: mean squares across and of height; None without truth."""
    if not (survey / "truth/returns.npy").exists():
        return None
    truth, points = np.load(survey / "truth/returns.npy"), common.points_of(output)
    order = common.paired(points, truth["t"] - 1e9, truth["rn"])
    good = ~np.isin(truth["cls"], common.OUTLIERS)
    error = common.errors_of(points, order, truth)[good]
    h, v = points["sigma_h"][order][good], points["sigma_v"][order][good]
    return np.mean(np.sum(error[:, :2] ** 2, axis=1) / h**2), np.mean((error[:, 2] / v) ** 2)


def fly(part, seed):
    folder = common.scratch(f"strips/{part}_{seed}")
    options, first = PARTS[part]
    options = {**SURVEY, **options, "seed": seed}
    if part == "outage":
        common.call("simulate", folder / "plan", "--quiet", *common.sets({**options, "output.laser": "false"}))
        plan = tomllib.loads((folder / "plan/survey.toml").read_text())
        start = next(float(l["start"].split()[0]) for l in plan["line"] if l["name"] == OUTAGE[0])
        begin = navigation.sbet(folder / "plan/truth/sbet.out")[0, 0]
        options["gnss.outage"] = f'[{{start = "{start - begin - OUTAGE[1]:.3f} s", length = "{OUTAGE[2]} s"}}]'
    survey, output = folder / "survey", folder / "out"
    if part == "own":
        options.update(calibrate(folder, seed))
    common.call("simulate", survey, "--quiet", *common.sets(options))
    if part == "own":
        text = (survey / "survey.toml").read_text()
        (survey / "survey.toml").write_text(f'calibration_file = "{folder / "calibration/calibration.json"}"\n{text}')
    stages = [{"type": t} for t in first] + [{"type": "readers.laser"}]
    if first == SMOOTHED:
        stages[2]["plots"] = []
    after = [{"type": t} for t in ("writers.trajectory", "georeference", "filters.returns")] + [{"type": "writers.las", "compress": False}]
    common.run(stages + after, survey / "survey.toml", folder / "before")
    report = common.run(stages + [{"type": "calib.strips"}] + after, survey / "survey.toml", output)
    told = common.stage_of(report, "calib.strips")["findings"]
    before, _ = measured(offsets(common.points_of(folder / "before"), survey))
    after, absolute = measured(offsets(common.points_of(output), survey))
    error, pull = pulls(output, survey)
    of_points = point_pulls(output, survey)
    checks = [c["residual"] for c in json.loads((output / "strips.json").read_text())["checks"]]
    if not os.environ.get("KEEP"):
        shutil.rmtree(folder)
    return before, after, absolute, error, pull, told, checks, of_points


def main():
    seeds = int(sys.argv[1]) if len(sys.argv) > 1 else 5
    cm = lambda values: f"{100 * common.rms(np.asarray(values)):.2f}"
    rows, spread = [], []
    for part in sys.argv[2:] or PARTS:
        with concurrent.futures.ThreadPoolExecutor(int(os.environ.get("WORKERS", "2"))) as pool:
            done = list(pool.map(lambda seed: fly(part, seed), range(1, seeds + 1)))
        before, after, absolute, error, pull, told, checks, of_points = ([d[k] for d in done] for k in range(8))
        all_of = np.concatenate
        rows.append([part, seeds, cm(all_of(before)), cm(all_of(after)), f"{max(100 * common.rms(a) for a in after):.2f}", cm(all_of(absolute)),
                     f"{max(100 * common.rms(a) for a in absolute):.2f}", cm(all_of(checks)), cm([t["plane_differences"]["rms_before"] for t in told]),
                     cm([t["plane_differences"]["rms_after"] for t in told])])
        errors, ratio = common.rms(all_of(error)), common.rms(all_of(pull))
        spread.append([part, " ".join(f"{100 * v:.1f}" for v in errors[:3]), " ".join(f"{v / navigation.ARCSEC:.1f}" for v in errors[3:]),
                       " ".join(f"{v:.2f}" for v in ratio),
                       "-" if of_points[0] is None else " ".join(f"{v:.2f}" for v in np.sqrt(np.mean(of_points, axis=0)))])
        for what in sorted({w for t in told for w in t["findings"]}):
            print(f"- {part}, {sum(what in t['findings'] for t in told)} of {seeds}: {what}")
    common.table(["survey", "seeds", "lines apart before, rms cm", "after", "worst seed", "from the true facets, rms cm", "worst seed", "check points cm",
                  "told before cm", "told after cm"], rows)
    common.table(["survey", "corrected trajectory, rms N E D cm", "roll pitch heading arcsec", "error/sigma N E D roll pitch heading",
                  "points' error/sigma across, height"], spread)


if __name__ == "__main__":
    main()
