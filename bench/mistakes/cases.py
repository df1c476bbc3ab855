# SPDX-License-Identifier: GPL-3.0-or-later
"""Mistakes in laser records, calibration, flight lines, control and CRS. trajectory_cases.py and navigation_cases.py hold the others."""
from dataclasses import dataclass
from typing import Callable

import numpy as np

from records import NotApplicable, number

FOOT, US_FOOT = 0.3048, 1200 / 3937
UNDULATION = 47.3  # m, geoid above the ellipsoid where the default survey lies
BOTH, RAW, GIVEN = ("raw", "sbet"), ("raw",), ("sbet",)


@dataclass
class Case:
    name: str
    what: str                    # the user's mistake
    edit: Callable               # puts it into a Survey
    ids: tuple = ()              # identifiers of the gate that name it; the first is the closest, the others are the same geometry
    chains: tuple = BOTH
    cause: str = ""              # messages that name it too (regular expression, case ignored)
    reason: str = ""             # why nothing in the records can show it
    shift: float = 0.0           # s, later than true that the laser's times become
    other_crs: bool = False      # products are right in another CRS: no error against truth


CASES = []


def add(name, what, ids="", **more):
    return lambda edit: CASES.append(Case(name, what, edit, tuple(ids.split()), **more)) or edit


def each(table, **more):
    """One mistake for each row (name, what, argument, ids) of a table: edit(survey, argument)."""

    def take(edit):
        for name, what, argument, ids, *own in table:
            add(name, what, ids, **{**more, **(own[0] if own else {})})(lambda s, a=argument: edit(s, a))
        return edit

    return take


ANGLE_WORDS = r"angle_unit|stated as|degrees|radians|gon\b"


@add("scan_angle_sign", "scan angles counted to port", "scan_angle_sign", cause="sign of the scan angle|angle_to_port")
def _(s):
    if "scan_angle" not in s["laser"]["columns"]:
        s.laser_column("y")[:] *= -1
    else:
        s["laser"]["angle_to_port"] = not s["laser"].get("angle_to_port", False)


@each([("degrees_as_radians", "degrees stated as radians", "rad", "scan_angle_degrees_as_radians"),
       ("degrees_as_gon", "degrees stated as gon", "gon", "scan_angle_gon scan_scale")], cause=ANGLE_WORDS)
def _(s, unit):
    s.laser_column("scan_angle")
    s["laser"]["angle_unit"] = unit


@each([("radians_as_degrees", "radians stated as degrees", np.pi / 180, "scan_angle_radians_as_degrees scan_angle_degrees_as_radians scan_scale"),
       ("gon_as_degrees", "gon stated as degrees", 1 / 0.9, "scan_angle_gon scan_scale"),
       ("angle_of_mirror", "mirror's angle taken for the beam's", 0.5, "scan_scale"),
       ("angle_1_percent_wide", "angles 1 % too large", 1.01, "scan_scale")], cause=ANGLE_WORDS + "|scan_scale")
def _(s, factor):
    s.laser_column("scan_angle")[:] *= factor


@each([("scan_scale_2", "scan_scale 2", 2.0, "scan_scale"), ("scan_scale_half", "scan_scale 0.5", 0.5, "scan_scale"),
       ("scan_scale_99", "scan_scale 0.99", 0.99, "scan_scale")], cause="scan_scale")
def _(s, factor):
    s["calibration"]["scan_scale"] = factor


@each([("model_conical", "wrong scanner model: conical", "conical", "scanner_model"),
       ("model_palmer", "wrong scanner model: palmer", "palmer", "scanner_model"),
       ("model_profile", "wrong scanner model: profile", "profile", "scanner_model"), ("model_mirror", "wrong scanner model: mirror", "mirror",
                                                                                       "scanner_model"),
       ("model_polygon", "wrong scanner model: polygon for an oscillating mirror", "polygon",
        "scanner_model")], cause=r"scanner\.model|scanner model|another model")
def _(s, model):
    if s["scanner"]["model"] == model:
        raise NotApplicable("the right one")
    s["scanner"]["model"] = model


@each([("range_metres_as_feet", "ranges in metres stated as feet", "0.3048 m", "range_feet")], cause="range_unit|feet")
def _(s, unit):
    s.laser()
    s["laser"]["range_unit"] = unit


@each([("range_feet", "ranges in feet stated as metres", 1 / FOOT, "range_feet"),
       ("range_us_feet", "ranges in US feet stated as feet", FOOT / US_FOOT, "",
        {"reason": "2 ppm: below 1 mm at this height"}),
       ("range_cm", "ranges in centimetres stated as metres", 100.0, "range_centimetres range_scale"),
       ("range_km", "ranges in kilometres stated as metres", 1e-3, "range_kilometres range_scale"),
       ("range_two_way", "two-way ranges", 2.0, "range_two_way"), ("range_half", "ranges halved twice", 0.5, "range_two_way"),
       ("range_300_ppm", "air's 300 ppm applied twice", 1.0003, "",
        {"reason": "0.1 m of height for all lines at this height, unless control shows it"})],
      cause="range_unit|range scale|ranges? .*(unit|twice|half|long|short|factor)")
def _(s, factor):
    s.scale_ranges(factor)


@each([("range_offset_sign", "range offset with the wrong sign", -1.0, "", {"reason": "8 cm of height for all lines, unless control shows it"}),
       ("range_offset_mm", "range offset in millimetres stated as metres", 1000.0, "range_offset")], cause="range_offset|range offset")
def _(s, factor):
    s["calibration"]["range_offset"] = f"{number(s['calibration']['range_offset']) * factor} m"


@add("range_and_angle_swapped", "columns of range and scan angle swapped", "columns_swapped", cause="column|range_unit|implausible|no range")
def _(s):
    columns = s["laser"]["columns"]
    s.laser_column("scan_angle")
    columns["scan_angle"], columns["range"] = columns["range"], columns["scan_angle"]


@add("intensity_as_range", "intensity read as range", "columns_swapped", cause="column|range_unit|implausible|no range")
def _(s):
    s.laser_column("range")
    s["laser"]["columns"]["range"] = s["laser"]["columns"]["intensity"]


@add("return_columns_swapped", "columns of return number and return count swapped", cause="return")
def _(s):
    columns = s["laser"]["columns"]
    columns["return_number"], columns["return_count"] = columns["return_count"], columns["return_number"]


TIME_WORDS = r"leap|UTC|18 s|time\.offset|latency|times? (is|are) .*(off|late|early|ahead)|week|of the day|lines' times"


WINDOW_WORDS = r"window|lines' times|lines? .*(no|without|few|less|beyond|outside)"


def shifted_windows(s, seconds):
    for line in s["line"]:
        for key in ("start", "end"):
            line[key] = f"{number(line[key]) + seconds:.6f} s"


def later(s, seconds):
    s.laser_column("time")[:] += seconds
    shifted_windows(s, seconds)  # the lines' times come from the same clock


@each([(f"laser_time_{t}", f"laser times {t} s late", t, ids, {"shift": t})
       for t, ids in ((0.01, "time_offset"), (0.1, "time_offset"), (-0.1, "time_offset"), (1.0, "time_offset"), (18.0, "leap_seconds"),
                      (-18.0, "leap_seconds"))],
      cause=TIME_WORDS)
def _(s, seconds):
    later(s, seconds)


@add("laser_latency_1ms_as_1s", "calibration.latency of 5 ms stated as 5 s", "time_offset", cause=TIME_WORDS)
def _(s):
    s["calibration"]["latency"] = "5 s"


@add("laser_windows_keep_18", "laser times in UTC, the lines' in GPS", "leap_seconds", cause=TIME_WORDS, shift=-18.0)
def _(s):
    s.laser_column("time")[:] -= 18.0


@add("laser_week", "laser records a week off", "gps_week", cause="week")
def _(s):
    s["laser"]["time"]["week"] += 1


@add("everything_a_week_off", "every file a week off", shift=604800.0, reason="a whole week for every record: nothing has a date of its own")
def _(s):
    for key in ("laser", "trajectory", "imu", "gnss"):
        if key in s.tree:
            s[key]["time"]["week"] += 1
    s.tree["line_time"]["week"] += 1


@add("laser_day_seconds", "laser times are seconds of the day", "day_seconds gps_week", cause=TIME_WORDS)
def _(s):
    later(s, -86400.0 * (s.laser_column("time")[0] // 86400))


@add("laser_milliseconds", "laser times in milliseconds stated as seconds", "time_unit", cause=TIME_WORDS)
def _(s):
    s.laser_column("time")[:] *= 1000.0


@add("laser_adjusted_stated", "seconds of week stated as adjusted standard GPS time", "gps_week", cause=TIME_WORDS)
def _(s):
    s["laser"]["time"] = {"scale": "gps_adjusted"}


@add("laser_unix_stated", "seconds of week stated as Unix time", "gps_week", cause=TIME_WORDS)
def _(s):
    s["laser"]["time"] = {"scale": "unix"}


@each([("boresight_roll", "sign of the boresight's roll", ("roll",), "boresight_roll_sign"),
       ("boresight_pitch", "sign of the boresight's pitch", ("pitch",), "boresight_pitch_sign"),
       ("boresight_heading", "sign of the boresight's heading", ("heading",), "boresight_heading_sign"),
       ("boresight_all", "signs of the whole boresight", ("roll", "pitch", "heading"), "boresight_sign")], cause="boresight")
def _(s, axes):
    for axis in axes:
        s["calibration"][axis] = f"{-number(s['calibration'][axis])} deg"


@add("boresight_radians", "boresight's degrees stated as radians", "boresight_degrees_as_radians boresight", cause="boresight|calibration\\.")
def _(s):
    for axis in ("roll", "pitch", "heading"):
        s["calibration"][axis] = s["calibration"][axis].replace("deg", "rad")


@add("boresight_swapped", "boresight's roll and pitch swapped", "axes_swapped boresight_axes_swapped", cause="boresight")
def _(s):
    c = s["calibration"]
    c["roll"], c["pitch"] = c["pitch"], c["roll"]


@add("boresight_missing", "boresight left out", "boresight_missing boresight", cause="boresight")
def _(s):
    for axis in ("roll", "pitch", "heading"):
        s["calibration"][axis] = "0 deg"


@each([("mount_rolled_90", "scanner mounted on its side: roll 90 deg too much", ("roll", 90), "mount_rolled"),
       ("mount_rolled_180", "scanner stated upside down: roll 180 deg too much", ("roll", 180), "mount_rolled"),
       ("mount_pitched_90", "mount pitched by 90 deg", ("pitch", 90), "mount_rolled mount_pitched axes_swapped"),
       ("mount_turned_180", "scanner stated backwards: heading 180 deg too much", ("heading", 180),
        "mount_turned mount_rolled scan_angle_sign axes_swapped"),
       ("mount_turned_90", "scanner stated across: heading 90 deg too much", ("heading", 90),
        "mount_turned mount_rolled axes_swapped")], cause="mount|upside|boresight")
def _(s, turn):
    axis, degrees = turn
    s["calibration"][axis] = f"{number(s['calibration'][axis]) + degrees} deg"


def lever(s, change):
    """Lever arm of the scanner: factors or a function on its three components."""
    arm = [number(v) for v in s["calibration"]["lever_arm_scanner"]]
    arm = change(arm) if callable(change) else [a * f for a, f in zip(arm, change)]
    s["calibration"]["lever_arm_scanner"] = [f"{v} m" for v in arm]


@each([("lever_forward", "sign of the scanner's lever arm forward", (-1, 1, 1), "lever_arm_sign lever_arm"),
       ("lever_right", "sign of the scanner's lever arm to the right", (1, -1, 1), "lever_arm_sign lever_arm",
        {"reason": "0.14 m: lines differ by no more than their sigmas let them"}),
       ("lever_down", "sign of the scanner's lever arm down", (1, 1, -1), "lever_arm_sign",
        {"reason": "height of all lines, 0.65 m: not observable between lines of one height, unless control shows it"}),
       ("lever_all", "signs of the whole lever arm of the scanner", (-1, -1, -1), "lever_arm_sign"),
       ("lever_mm", "scanner's lever arm in millimetres stated as metres", (1e3, 1e3, 1e3), "lever_arm_millimetres"),
       ("lever_cm", "scanner's lever arm in centimetres stated as metres", (1e2, 1e2, 1e2), "lever_arm_millimetres lever_arm_centimetres"),
       ("lever_feet", "scanner's lever arm in feet stated as metres", (1 / FOOT,) * 3, "lever_arm_feet lever_arm"),
       ("lever_missing", "scanner's lever arm left out", (0, 0, 0), "lever_arm_missing lever_arm"),
       ("lever_flu", "scanner's lever arm forward, left, up", (1, -1, -1), "lever_arm_axes lever_arm_sign axes_swapped"),
       ("lever_x_y", "scanner's lever arm right, forward, down", lambda a: [a[1], a[0], a[2]], "lever_arm_axes axes_swapped lever_arm"),
       ("lever_y_z", "scanner's lever arm forward, down, right", lambda a: [a[0], a[2], a[1]], "lever_arm_axes axes_swapped lever_arm")],
      cause="lever")
def _(s, change):
    lever(s, change)


@each([("windows_20_s", "flight lines' windows 20 s late", 20.0, "line_windows"),
       ("windows_2_s", "flight lines' windows 2 s late", 2.0, "line_windows")],
      cause=WINDOW_WORDS)
def _(s, seconds):
    shifted_windows(s, seconds)


@add("windows_week", "flight lines' windows a week off", "gps_week line_windows", cause=WINDOW_WORDS + "|week")
def _(s):
    s.tree["line_time"]["week"] += 1


@add("windows_swapped", "windows of two flight lines swapped", "line_windows", cause=WINDOW_WORDS)
def _(s):
    a, b = s["line"][0], s["line"][1]
    for key in ("start", "end"):
        a[key], b[key] = b[key], a[key]


@add("line_missing", "one flight line is not listed", cause=WINDOW_WORDS)
def _(s):
    del s.tree["line"][1]


@add("records_of_a_line_missing", "one flight line's records are missing", cause=WINDOW_WORDS)
def _(s):
    table = s.laser()
    s.set_laser(table[table[s["laser"]["columns"]["line"]] != s["line"][1]["id"]])


@add("records_cut", "laser file cut after three quarters of its records", cause=WINDOW_WORDS + "|cut|ends before|incomplete")
def _(s):
    s.set_laser(s.laser()[: len(s.laser()) * 3 // 4])


@add("records_twice", "the same laser file stated twice", cause="twice|repeat|same|duplicate")
def _(s):
    s.laser()
    s.tree["laser"].append(dict(s.tree["laser"][0]))


CONTROL = dict(cause="control|check", ids="control")


@each([("control_geoid", "control's heights above the geoid", lambda v, axis: v - UNDULATION if axis == "z" else v, "height_geoid control"),
       ("control_feet", "control's heights in feet", lambda v, axis: v / FOOT if axis == "z" else v, "control_feet control"),
       ("control_all_feet", "control's coordinates in feet", lambda v, axis: v / FOOT, "control_feet control"),
       ("control_far", "control 100 km off (false easting left out)", lambda v, axis: v - 1e5 if axis == "x" else v, "control"),
       ("control_10_m", "control 10 m too high", lambda v, axis: v + 10 if axis == "z" else v, "control")], cause="control|check")
def _(s, change):
    s.control_rows(lambda row: row.update({axis: f"{change(float(row[axis]), axis):.6f}" for axis in "xyz"}))


@add("control_x_y", "control's easting and northing swapped", "control axes_swapped", cause="control|check")
def _(s):
    s.control_rows(lambda row: row.update(x=row["y"], y=row["x"]))


@add("control_zone", "control's CRS a zone off", "control", cause="control|check")
def _(s):
    for control in s["control"]:
        control["crs"] = neighbour(s.tree["crs"])


@add("control_sigma", "control's sigmas in millimetres stated as metres", reason="a sigma that is too large hides nothing but its own weight",
     cause="control|sigma")
def _(s):
    s.control_rows(lambda row: row.update(sigma_h=str(float(row["sigma_h"]) * 1000), sigma_v=str(float(row["sigma_v"]) * 1000)))


def neighbour(crs):
    """The UTM zone to the east."""
    code = int(crs.removeprefix("EPSG:"))
    return f"EPSG:{code + 1}"


@each([("crs_zone", "products' UTM zone one too far east", neighbour, ""),
       ("crs_hemisphere", "products' CRS of the southern hemisphere", lambda crs: f"EPSG:{int(crs.removeprefix('EPSG:')) + 100}", ""),
       ("crs_feet", "products' CRS in US survey feet (California)", lambda crs: "EPSG:2227", ""),
       ("crs_degrees", "products' CRS in degrees", lambda crs: "EPSG:4326", "")], cause="crs|area of use|zone", other_crs=True)
def _(s, change):
    s.tree["crs"] = change(s.tree["crs"])


@add("crs_datum", "products' CRS in another datum (ETRS89 for WGS84)", reason="WGS84 and ETRS89 are the same to PROJ; the records state no frame",
     other_crs=True)
def _(s):
    if not s.tree["crs"].startswith("EPSG:326"):
        raise NotApplicable("not in Europe's zones")
    s.tree["crs"] = s.tree["crs"].replace("EPSG:326", "EPSG:258")


@add("air_twice", "atmosphere's correction of corrected ranges", cause="air|range", reason="0.1 m of height for all lines, unless control shows it")
def _(s):
    s["scanner"].update(air="ciddor", group_index=1.0)


@add("sigma_calibration", "calibration's sigmas 100 times too small", reason="sigmas state what is believed of the values")
def _(s):
    for key, value in s["sigma"].items():
        unit = f" {value.split()[1]}" if isinstance(value, str) else ""
        s["sigma"][key] = f"{number(value) / 100}{unit}" if unit else number(value) / 100
