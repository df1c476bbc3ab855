# SPDX-License-Identifier: GPL-3.0-or-later
"""Mistakes in IMU and GNSS records."""
import numpy as np

from cases import FOOT, RAW, TIME_WORDS, UNDULATION, add, each
from records import number

GYROS, ACCELEROMETERS = ("gyro_x", "gyro_y", "gyro_z"), ("accelerometer_x", "accelerometer_y", "accelerometer_z")
IMU_WORDS = "gyro|gravity|specific force|angular rate|axes|mounting"


@each([("imu_ned_as_enu", "IMU axes right, forward, up stated for forward, right, down", ["y", "x", "-z"], "axes_swapped"),
       ("imu_flu", "IMU axes forward, left, up stated", ["x", "-y", "-z"], "axes_swapped"),
       ("imu_turned_90", "IMU turned by 90 deg", ["y", "-x", "z"], "axes_swapped"), ("imu_turned_180", "IMU turned by 180 deg", ["-x", "-y", "z"],
                                                                                     "axes_swapped")],
      chains=RAW, cause=IMU_WORDS + "|imu\\.heading")
def _(s, axes):
    s["imu"]["axes"] = axes


@each([("imu_heading_90", "IMU mounting's heading 90 deg off", ("heading", 90), "axes_swapped"),
       ("imu_roll_180", "IMU mounting's roll 180 deg off", ("roll", 180), "axes_swapped mount_rolled"),
       ("imu_pitch_10", "IMU mounting's pitch 10 deg off", ("pitch", 10),
        "boresight_pitch_sign boresight")], chains=RAW, cause=IMU_WORDS + "|not level|imu\\.heading")
def _(s, turn):
    s["imu"][turn[0]] = f"{turn[1]} deg"


@each([("imu_gyro_x_sign", "sign of the roll gyro", ("gyro_x",), "imu_axis_sign roll_sign"),
       ("imu_gyro_z_sign", "sign of the heading gyro", ("gyro_z",), "imu_axis_sign heading_sign"),
       ("imu_gyro_signs", "signs of all gyros", GYROS, "imu_axis_sign"), ("imu_accelerometer_x_sign", "sign of the forward accelerometer",
                                                                          ("accelerometer_x",), "imu_axis_sign")],
      chains=RAW, cause=IMU_WORDS + "|sign")
def _(s, names):
    for name in names:
        s.column("imu", name)[:] *= -1


@each([("imu_gyros_degrees", "gyros in degrees stated as radians", (GYROS, 180 / np.pi), "imu_units"),
       ("imu_g", "accelerations in g stated as m/s2", (ACCELEROMETERS, 1 / 9.80665), "imu_units"),
       ("imu_milli_g", "accelerations in mg stated as m/s2", (ACCELEROMETERS, 1000 / 9.80665), "imu_units"),
       ("imu_rates", "rates stated as increments", (GYROS + ACCELEROMETERS, 200.0), "imu_units")], chains=RAW, cause=IMU_WORDS)
def _(s, what):
    for name in what[0]:
        s.column("imu", name)[:] *= what[1]


@each([("imu_as_rates", "increments stated as rates", {"kind": "rates"}, "imu_units"),
       ("imu_radians_as_degrees", "gyros in radians stated as degrees", {"angle_unit": "deg"}, "imu_units"),
       ("imu_as_g", "accelerations in m/s2 stated as g", {"acceleration_unit": "g"}, "imu_units"), ("imu_rate_100", "IMU's rate stated as half",
                                                                                                    {"rate": "100 Hz"}, "imu_rate")],
      chains=RAW, cause=IMU_WORDS + "|rate|step|gap")
def _(s, stated):
    s["imu"].update(stated)


@each([(f"imu_time_{t}", f"IMU times {t} s late", t, ids) for t,
       ids in ((0.005, "time_offset"), (0.1, "time_offset"), (1.0, "time_offset"), (18.0, "leap_seconds"))], chains=RAW,
      cause=TIME_WORDS)
def _(s, seconds):
    s.column("imu", "time")[:] += seconds


@add("imu_week", "IMU a week off", "gps_week", chains=RAW, cause="week")
def _(s):
    s["imu"]["time"]["week"] += 1


@add("imu_day_seconds", "IMU times are seconds of the day", "day_seconds gps_week", chains=RAW, cause=TIME_WORDS)
def _(s):
    s.column("imu", "time")[:] %= 86400.0


@add("imu_grade", "IMU's grade stated too good (navigation)", chains=RAW, cause="imu|bias|innovation|noise",
     reason="sigmas state what is believed of the sensor")
def _(s):
    s.tree["imu_spec"] = {"grade": "navigation"}


def antenna(s, change):
    arm = [number(v) for v in s["antenna"]["lever_arm"]]
    arm = change(arm) if callable(change) else [a * f for a, f in zip(arm, change)]
    s["antenna"]["lever_arm"] = [f"{v} m" for v in arm]


@each([("antenna_forward", "sign of the antenna's lever arm forward", (-1, 1, 1), "antenna_lever_arm lever_arm_sign"),
       ("antenna_right", "sign of the antenna's lever arm to the right", (1, -1, 1), "antenna_lever_arm lever_arm_sign"),
       ("antenna_down", "sign of the antenna's lever arm down", (1, 1, -1), "antenna_lever_arm lever_arm_sign"),
       ("antenna_all", "signs of the antenna's whole lever arm", (-1, -1, -1), "antenna_lever_arm lever_arm_sign"),
       ("antenna_mm", "antenna's lever arm in millimetres stated as metres", (1e3, 1e3, 1e3), "antenna_lever_arm lever_arm_millimetres"),
       ("antenna_x_y", "antenna's lever arm right, forward, down", lambda a: [a[1], a[0], a[2]], "antenna_lever_arm axes_swapped"),
       ("antenna_missing", "antenna's lever arm left out", (0, 0, 0), "antenna_lever_arm")], chains=RAW, cause="lever arm|antenna")
def _(s, change):
    antenna(s, change)


@each([(f"gnss_time_{t}", what, t, ids) for t, what,
       ids in ((0.1, "GNSS times 0.1 s late", "time_offset"), (1.0, "GNSS times 1 s late", "time_offset"),
               (-18.0, "GNSS times in UTC", "leap_seconds"))],
      chains=RAW, cause=TIME_WORDS + "|UTC")
def _(s, seconds):
    s.column("gnss", "time")[:] += seconds


@add("gnss_week", "GNSS a week off", "gps_week", chains=RAW, cause="week")
def _(s):
    s["gnss"]["time"]["week"] += 1


@each([("gnss_sigmas_100", "GNSS sigmas 100 times too large", 1e4, ""), ("gnss_sigmas_small", "GNSS sigmas 100 times too small", 1e-4, "")],
      chains=RAW,
      cause="sigma|scatter|innovation", reason="sigmas state what is believed of the fixes; the smoother rates them against one another")
def _(s, factor):
    for name in ("cov_xx", "cov_xy", "cov_xz", "cov_yy", "cov_yz", "cov_zz"):
        s.column("gnss", name)[:] *= factor


def geodetic(s, **changes):
    """GNSS by latitude, longitude, height (columns of the file) in place of ECEF; `changes` of a column by its name in the program."""
    names, table = s.text_table("gnss")
    columns = {k: v for k, v in s["gnss"]["columns"].items() if k in ("time", "quality", "satellites")}
    s["gnss"]["columns"] = columns | {"latitude": "lat_deg", "longitude": "lon_deg", "height": "h_ell_m", "sigma_north": "sd_north_m",
                                      "sigma_east": "sd_east_m",
                                      "sigma_up": "sd_down_m"}
    s["gnss"]["angle_unit"] = "deg"
    for name, change in changes.items():
        s.column("gnss", name)[:] = change(s.column("gnss", name))
    return s["gnss"]


def minutes(degrees):
    """Degrees and minutes as one number, ddmm.mmmm."""
    whole = np.trunc(degrees)
    return whole * 100 + (degrees - whole) * 60


@each([("gnss_geodetic", "GNSS by latitude and longitude, rightly stated", {}, "", {"reason": "no mistake: the geodetic form itself"}),
       ("gnss_geoid", "GNSS heights above the geoid", {"height": lambda h: h - UNDULATION}, "height_geoid"),
       ("gnss_feet", "GNSS heights in feet", {"height": lambda h: h / FOOT}, "trajectory_height_feet"),
       ("gnss_west", "GNSS longitude's sign", {"longitude": lambda v: -v}, ""), ("gnss_south", "GNSS latitude's sign", {"latitude": lambda v: -v},
                                                                                 ""),
       ("gnss_minutes", "GNSS degrees and minutes stated as degrees", {"latitude": minutes, "longitude": minutes}, "")], chains=RAW,
      cause="geoid|feet|latitude|longitude|area of use|near the ground|500 m/s")
def _(s, changes):
    geodetic(s, **changes)


@add("gnss_geoid_without_control", "GNSS heights above the geoid, no control", "height_geoid", chains=RAW,
     reason="nothing in the records knows a height of the ground")
def _(s):
    geodetic(s, height=lambda h: h - UNDULATION)
    s.tree.pop("control", None)


@add("gnss_lat_lon_swapped", "GNSS columns of latitude and longitude swapped", "axes_swapped", chains=RAW, cause="latitude|longitude|area of use")
def _(s):
    columns = geodetic(s)["columns"]
    columns["latitude"], columns["longitude"] = "lon_deg", "lat_deg"


@add("gnss_radians_stated", "GNSS degrees stated as radians", chains=RAW, cause="latitude|rad")
def _(s):
    geodetic(s)["angle_unit"] = "rad"


@add("gnss_x_y_swapped", "GNSS columns of ECEF x and y swapped", "axes_swapped", chains=RAW, cause="column|area of use|near the ground")
def _(s):
    columns = s["gnss"]["columns"]
    columns["x"], columns["y"] = columns["y"], columns["x"]


@add("gnss_datum", "GNSS in another datum, 0.75 m off", chains=RAW, reason="a datum's shift is the same for all records, unless control shows it")
def _(s):
    for name, shift in zip("xyz", (0.31, 0.49, 0.42)):
        s.column("gnss", name)[:] += shift


@add("gnss_other_flight", "GNSS of another flight over the same place at the same time of the week", "trajectory_other_flight", chains=RAW,
     cause="contradict|scatter|another flight")
def _(s):
    s.text_table("gnss")
    s.arrays[s["gnss"]["file"]][1][:] = 0
    other = np.loadtxt(s.other() / "gnss.csv", delimiter=",", skiprows=1)
    s.arrays[s["gnss"]["file"]] = s.arrays[s["gnss"]["file"]][0], other
