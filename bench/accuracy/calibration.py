# SPDX-License-Identifier: GPL-3.0-or-later
"""Simulated calibration flights, raw records to calibration.json, against truth: calibration.py [SEEDS [PART ...]]

Every flight has a boresight, a range offset and a scan scale drawn by its seed; IMU and GNSS records go through the smoother.
Parts: roof (its plane is surveyed), strips (no control), no_cross, one_direction, one_line, flat, mems, uav (32 beams from 40 m over a town, two
lines to and fro, no cross lines, MEMS). "unsettled" counts flights whose values still moved. $PRF is the laser's pulse rate ("30 kHz"), $LENGTH that
of a line ("800 m"); with $RESUME flights done before by the same program are not flown again."""
import concurrent.futures
import json
import os
import re
import shutil
import sys

import numpy as np

import common

FLIGHT = {"world.scene": "airfield", "flight.pattern": "calibration", "output.trajectory": "none", "output.truth_returns": "false"}
PARTS = {
    "roof": ({"control.roof": "true"}, {}),
    "strips": ({"control.roof": "false"}, {}),
    "no_cross": ({"control.roof": "false", "flight.cross_lines": 0}, {}),
    "one_direction": ({"control.roof": "false", "flight.opposite": "false", "flight.cross_lines": 0}, {}),
    "one_line": ({"control.roof": "true", "flight.lines": 1, "flight.cross_lines": 0}, {}),
    "flat": ({"control.roof": "false", "world.buildings": 0}, {}),
    "mems": ({"control.roof": "true", "imu.grade": "mems"}, {}),
    "uav": ({"world.scene": "town", "world.length": "160 m", "world.width": "90 m", "flight.pattern": "block", "flight.lines": 2,
             "flight.cross_lines": 0, "flight.overlap": 0.7, "flight.height": "40 m", "flight.speed": "6 m/s", "scanner.pattern": "multibeam",
             "scanner.half_angle": "45 deg", "scanner.forward_tilt": "20 deg", "scanner.frequency": "10 Hz", "scanner.prf": "40 kHz",
             "scanner.divergence": "3 mrad", "scanner.max_returns": 2, "noise.range": "2 cm", "imu.grade": "mems", "mounting.deliver": "nominal",
             **{f"mounting.truth.{k}": v for k, v in {"roll": "0 deg", "pitch": "0 deg", "heading": "0 deg", "range_offset": "0 m", "scan_scale": 1.0}.items()},
             "mounting.random_boresight": "0.5 deg", "mounting.random_range_offset": "2 cm", "mounting.random_scan_scale": 1e-4}, {}),
}
ARCSEC = np.degrees(1) * 3600
# key in calibration.json, unit of the table, what an SI value is multiplied by
VALUES = [("roll", '"', ARCSEC), ("pitch", '"', ARCSEC), ("heading", '"', ARCSEC), ("range_offset", "mm", 1e3), ("scan_scale", "ppm", 1e6)]


def number(value):
    """An SI number of "0.05 deg", "4 cm" or 1.0003."""
    if isinstance(value, (int, float)):
        return float(value)
    amount, unit = value.split()
    return float(amount) * {"deg": np.radians(1), "rad": 1, "mrad": 1e-3, "arcsec": 1 / ARCSEC, "m": 1, "cm": 1e-2, "mm": 1e-3, "s": 1}[unit]


def fly(part, seed):
    """One flight: start error, error, sigma and whether it was delivered, per value; findings; the flat target's readings: error, sigma,
    difference from the adjustment over the joint sigma; by how many sigmas the last round moved a value. Its folder is deleted."""
    kept = common.SCRATCH / "calibration" / f"{part}_{seed}.json"
    if os.environ.get("RESUME") and kept.exists():
        done = json.loads(kept.read_text())
        return np.array(done["rows"]), done["findings"], done.get("readings", {}), done.get("move", np.nan)
    folder = common.scratch(f"calibration/{part}_{seed}")
    options, settings = PARTS[part]
    for name, option in {"PRF": "scanner.prf", "LENGTH": "flight.line_length"}.items():
        if name in os.environ:
            options = {**options, option: os.environ[name]}
    common.call("simulate", folder / "survey", "--quiet", *common.sets({**FLIGHT, **options, "seed": seed}))
    output = folder / "out"
    common.call("run", common.ROOT / "configs/calibrate.toml", "--survey", folder / "survey/survey.toml", "--output", output, "--quiet",
                *common.sets({"ins_gnss.plots": "[]", **settings}))
    truth = json.loads((folder / "survey/truth/calibration.json").read_text())
    found = json.loads((output / "calibration.json").read_text())
    estimates = {e["parameter"].removeprefix("boresight_"): e for e in found["estimates"]}
    rows = []
    for key, _, scale in VALUES:
        e, true = estimates[key], number(truth[key])
        if not e["delivered"]:  # nothing but the start value is told
            rows.append([scale * (e["nominal"] - true), *[np.nan] * 5, 0.0])
            continue
        rows.append([scale * (e["nominal"] - true), scale * (e["value"] - true), scale * e["sigma"], scale * e["formal"], scale * e["white"],
                     scale * (e["jackknife_lines"] or np.nan), 1.0])
    if not os.environ.get("KEEP"):
        shutil.rmtree(folder)
    findings = [f["what"] for f in found["findings"]]
    readings = {}
    for r in found["readings"]:
        key = r["parameter"].removeprefix("boresight_")
        scale = {k: s for k, _, s in VALUES}.get(key)
        if scale and "difference" in r:
            readings[key] = [scale * (r["value"] - number(truth[key])), scale * r["sigma"], r["difference"] / r["joint_sigma"]]
    moves = [re.search(r"no value by more than (\S+) of its sigmas", note) for note in found["notes"]]
    move = next((float(m.group(1)) for m in moves if m), np.nan)
    kept.write_text(json.dumps({"rows": rows, "findings": findings, "readings": readings, "move": move}))
    return np.array(rows), findings, readings, move


def main():
    seeds = int(sys.argv[1]) if len(sys.argv) > 1 else 20
    for part in sys.argv[2:] or ["roof", "strips", "no_cross", "one_direction", "one_line", "flat", "mems", "uav"]:
        with concurrent.futures.ThreadPoolExecutor(int(os.environ.get("WORKERS", "2"))) as pool:
            done = list(pool.map(lambda seed: fly(part, seed), range(1, seeds + 1)))
        rows = np.stack([r for r, *_ in done])
        print(f"## {part}, {seeds} seeds")
        table = []
        for k, (key, unit, _) in enumerate(VALUES):
            start, error, sigma, formal, white, jackknife, delivered = rows[:, k].T
            if not delivered.any():
                table.append([f"{key} ({unit})", f"{common.rms(start):.1f}", *["refused"] * 8, "0"])
                continue
            error, sigma, formal, white, jackknife = (v[delivered > 0] for v in (error, sigma, formal, white, jackknife))
            table.append([f"{key} ({unit})", f"{common.rms(start):.1f}", f"{common.rms(error):.2f}", f"{np.abs(error).max():.2f}",
                          f"{common.rms(sigma):.2f}", f"{common.rms(error / sigma):.2f}", f"{common.rms(formal):.2f}",
                          f"{common.rms(error / formal):.2f}", f"{np.sqrt(np.nanmean(jackknife**2)):.2f}", f"{common.rms(error / white):.1f}",
                          f"{int(delivered.sum())}"])
        common.table(["value", "start rms", "error rms", "largest", "sigma", "error/sigma", "formal", "error/formal", "jackknife (lines)",
                      "error/white", "delivered"], table)
        target = []
        for key, unit, _ in VALUES:
            found = np.array([readings[key] for _, _, readings, _ in done if key in readings])
            if len(found):
                error, sigma, apart = found.T
                target.append([f"{key} ({unit})", len(found), f"{common.rms(error):.2f}", f"{common.rms(sigma):.2f}",
                               f"{common.rms(error / sigma):.2f}", f"{common.rms(apart):.2f}", f"{np.abs(apart).max():.2f}"])
        if target:
            common.table(["flat target's", "flights", "error rms", "sigma", "error/sigma", "difference from the adjustment/joint sigma", "largest"], target)
        unsettled = sum(any("did not settle" in w for w in words) for _, words, *_ in done)
        calibrated = [move for rows_of, _, _, move in done if rows_of[:, 6].all()]
        print(f"- unsettled: {unsettled} of {seeds}; largest last move of those delivered, in sigmas: {max(calibrated, default=np.nan):.2f}")
        for what in sorted({w for _, words, *_ in done for w in words}):
            print(f"- {sum(what in words for _, words, *_ in done)} of {seeds}: {what}")


if __name__ == "__main__":
    main()
