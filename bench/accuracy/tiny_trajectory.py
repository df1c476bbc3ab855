# SPDX-License-Identifier: GPL-3.0-or-later
"""tiny_survey's 30 s of IMU and GNSS records to the smoothed trajectory and on to points with the true calibration, against truth by another program."""
import json

import numpy as np

import common
import navigation

SURVEY = """name = "tiny"
crs = "EPSG:32632"

[scanner]
model = "mirror"

[calibration]
roll = "{boresight_roll_deg} deg"
pitch = "{boresight_pitch_deg} deg"
heading = "{boresight_heading_deg} deg"
lever_arm_scanner = {scanner}
range_offset = "{range_offset_m} m"
scan_scale = {scan_scale}
scan_offset = "{scan_offset_deg} deg"
latency = "{latency_s} s"

[[laser]]
file = "{data}/laser.npy"
angle_unit = "deg"
time = {{ scale = "gps_week", week = 2317 }}
columns = {{ time = "t", line = "line", scan_angle = "angle_deg", range = "range", intensity = "intensity", return_number = "rn", return_count = "nr" }}

[[imu]]
file = "{data}/imu.csv"
time = {{ scale = "gps_week", week = 2317 }}
kind = "increments"
angle_unit = "rad"
acceleration_unit = "m/s2"
columns = {{ time = "gps_sow_s", gyro_x = "dtheta_x_rad", gyro_y = "dtheta_y_rad", gyro_z = "dtheta_z_rad", accelerometer_x = "dv_x_mps", accelerometer_y = "dv_y_mps", accelerometer_z = "dv_z_mps" }}

[imu_spec]
gyro_bias = "{gyro_bias_1sigma_deg_per_h} deg/h"
gyro_drift = "{gyro_bias_gm_deg_per_h} deg/h"
angular_random_walk = "{angular_random_walk_deg_per_sqrt_h} deg/sqrt(h)"
gyro_scale = "{gyro_scale_factor_ppm} ppm"
accelerometer_bias = "{accel_bias_1sigma_micro_g} ug"
accelerometer_drift = "{accel_bias_gm_micro_g} ug"
velocity_random_walk = "{velocity_random_walk_mps_per_sqrt_h} m/s/sqrt(h)"
accelerometer_scale = "{accel_scale_factor_ppm} ppm"
drift_time = "{bias_correlation_time_s} s"

[[gnss]]
file = "{data}/gnss.csv"
time = {{ scale = "gps_week", week = 2317 }}
columns = {{ time = "gps_sow_s", latitude = "lat_deg", longitude = "lon_deg", height = "h_ell_m", sigma_north = "sd_north_m", sigma_east = "sd_east_m", sigma_up = "sd_down_m", satellites = "n_sat" }}

[antenna]
lever_arm = {antenna}

[line_time]
scale = "gps_week"
week = 2317

[[line]]
id = 1
start = "474009 s"
end = "474034 s"
"""


def metres(values):
    return json.dumps([f"{v} m" for v in values])


data = common.reference("tiny_survey")
sensor = json.loads((data / "sensor.json").read_text())
calibration = json.loads((data / "truth/truth.json").read_text())["calibration"]
folder = common.scratch("tiny_trajectory")
survey = folder / "survey.toml"
survey.write_text(SURVEY.format(**calibration, **sensor["imu"]["spec"], data=data, scanner=metres(calibration["lever_arm_imu_to_scanner_frd_m"]),
                                antenna=metres(sensor["gnss"]["lever_arm_imu_to_antenna_frd_m"])))
output = folder / "out"
common.run(navigation.STAGES + [{"type": "readers.laser"}, {"type": "georeference"}, {"type": "writers.las", "compress": False, "scale": 0.0001}], survey, output)

flown, truth = navigation.sbet(output / "trajectory.sbet"), navigation.sbet(data / "truth/sbet.out")
time, error, inside = navigation.errors(flown, truth)
spread = navigation.sigmas(output / "trajectory.smrmsg")[inside]
sigma = np.concatenate([spread[:, 1:4], spread[:, 7:10]], axis=1)
unit = np.array([0.01] * 3 + [navigation.ARCSEC] * 3)
rows = []
for name, span in (("all", (time[0], time[-1])), ("line", (474009, 474034))):
    here = navigation.within(time, [span])
    e, s = error[here], sigma[here]
    for i, axis in enumerate(navigation.AXES):
        rows.append([name, axis, "cm" if i < 3 else "arcsec", *(f"{v / unit[i]:.2f}" for v in (e[:, i].mean(), common.rms(e[:, i]), np.abs(e[:, i]).max(), common.rms(s[:, i]))),
                     f"{common.rms(e[:, i] / s[:, i]):.2f}", f"{np.abs(e[:, i] / s[:, i]).max():.2f}"])
common.table(["span", "component", "unit", "mean", "rms", "largest", "printed sigma", "error/sigma", "largest error/sigma"], rows)
report = navigation.findings(output)
common.table(["NIS (3)", "band", "correlated share", "alignment", "warnings"],
             [[f"{report['innovations']['mean_nis']:.2f}", " to ".join(f"{v:.2f}" for v in report["innovations"]["band_95"]),
               f"{report['fixes']['correlated_share']:.2f}", report["alignment"]["method"], "; ".join(report["warnings"]) or "none"]])

returns = np.load(data / "truth/returns.npy")
points = common.points_of(output)
order = common.paired(points, common.adjusted(returns["t"]), returns["rn"])
error = common.errors_of(points, order, returns, ("E", "N", "h"))
h, v = points["sigma_h"][order] / np.sqrt(2), points["sigma_v"][order]
common.table(["returns", "mean E N U cm", "rms E N U cm", "RMS 3D cm", "error/sigma E N U"],
             [[len(error), " ".join(f"{100 * m:+.2f}" for m in error.mean(axis=0)), " ".join(f"{100 * m:.2f}" for m in common.rms(error)),
               f"{100 * np.sqrt(np.mean(np.sum(error**2, axis=1))):.2f}", " ".join(f"{m:.2f}" for m in common.rms(error / np.stack([h, h, v], axis=1)))]])
