# SPDX-License-Identifier: GPL-3.0-or-later
"""tiny_survey, a simulation by an independent program: every return against its true place, from CSV, NPY and SOCS LAS."""
import json

import numpy as np

import common

SURVEY = """name = "tiny"
crs = "EPSG:32632"

[scanner]
model = "mirror"

[calibration]
roll = "{boresight_roll_deg} deg"
pitch = "{boresight_pitch_deg} deg"
heading = "{boresight_heading_deg} deg"
lever_arm_scanner = [{lever}]
range_offset = "{range_offset_m} m"
scan_scale = {scan_scale}
scan_offset = "{scan_offset_deg} deg"
latency = "{latency_s} s"

[[laser]]
file = "{file}"
{laser}
[[trajectory]]
file = "{sbet}"
time = {{ scale = "gps_week", week = 2317 }}

[line_time]
scale = "gps_week"
week = 2317

[[line]]
id = 1
start = "474009 s"
end = "474034 s"
"""
COLUMNS = """angle_unit = "deg"
time = {{ scale = "gps_week", week = 2317 }}
columns = {{ time = "{}", line = "line", scan_angle = "{}", range = "{}", intensity = "intensity", return_number = "{}", return_count = "{}" }}
"""
FILES = {
    "CSV": ("laser.csv", COLUMNS.format("gps_sow_s", "scan_angle_deg", "range_m", "return_number", "number_of_returns")),
    "NPY": ("laser.npy", COLUMNS.format("t", "angle_deg", "range", "rn", "nr")),
    "SOCS LAS": ("laser_socs.las", 'time = { scale = "gps_adjusted" }\n'),
}

data = common.reference("tiny_survey")
calibration = json.loads((data / "truth/truth.json").read_text())["calibration"]
truth = np.load(data / "truth/returns.npy")
folder = common.scratch("tiny_survey")
errors = {}
for name, (file, laser) in FILES.items():
    survey = folder / f"{file}.toml"
    lever = ", ".join(f'"{v} m"' for v in calibration["lever_arm_imu_to_scanner_frd_m"])
    survey.write_text(SURVEY.format(**calibration, lever=lever, file=data / file, laser=laser, sbet=data / "truth/sbet.out"))
    common.run(common.ROOT / "configs/georeference.toml", survey, folder / name, las__scale="0.0001")
    points = common.points_of(folder / name)
    order = common.paired(points, common.adjusted(truth["t"]), truth["rn"])
    errors[name] = common.errors_of(points, order, truth, ("E", "N", "h"))

common.table(
    ["records", "returns", "mean E N U mm", "rms E N U mm", "RMS 3D cm", "largest 3D cm", "farthest from CSV mm"],
    [[name, len(e), " ".join(f"{1e3 * v:+.2f}" for v in e.mean(axis=0)), " ".join(f"{1e3 * v:.1f}" for v in common.rms(e)),
      f"{100 * np.sqrt(np.mean(np.sum(e * e, axis=1))):.3f}", f"{100 * np.linalg.norm(e, axis=1).max():.1f}",
      f"{1e3 * np.linalg.norm(e - errors['CSV'], axis=1).max():.3f}"] for name, e in errors.items()])
