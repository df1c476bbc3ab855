# SPDX-License-Identifier: GPL-3.0-or-later
"""Mistakes in the given trajectory."""
import numpy as np

from cases import FOOT, GIVEN, TIME_WORDS, UNDULATION, add, each
from records import COLUMN, NotApplicable, number

A, E2 = 6378137.0, 0.0066943799901413165  # WGS84
DATUM = (0.45, 0.52, -0.3)  # m north, east, up: ITRF2014 against ETRS89 in central Europe, about


def radii(latitude, height):
    """Metres per radian of latitude and of longitude."""
    w = np.sqrt(1 - E2 * np.sin(latitude) ** 2)
    return A * (1 - E2) / w**3 + height, (A / w + height) * np.cos(latitude)


def convergence(s):
    """Meridian convergence along the SBET in the survey's UTM zone, rad."""
    code = int(s.tree["crs"].removeprefix("EPSG:"))
    if code // 100 not in (326, 327):
        raise NotApplicable("not UTM")
    latitude, longitude = s.sbet("latitude"), s.sbet("longitude")
    return np.arctan(np.tan(longitude - np.radians(6 * (code % 100) - 183)) * np.sin(latitude))


def moved(s, north, east, up):
    table = s.sbet()
    per_lat, per_lon = radii(table[:, 1], table[:, 3])
    table[:, 1] += north / per_lat
    table[:, 2] += east / per_lon
    table[:, 3] += up


@each([("sbet_feet", "SBET heights in feet", lambda h: h / FOOT, "trajectory_height_feet"),
       ("sbet_us_feet", "SBET heights in US feet", lambda h: h * 3937 / 1200, "trajectory_height_feet"),
       ("sbet_geoid", "SBET heights above the geoid", lambda h: h - UNDULATION,
        "height_geoid")], chains=GIVEN, cause="geoid|feet|height (unit|system)")
def _(s, change):
    s.sbet()[:, COLUMN["height"]] = change(s.sbet("height"))


@add("sbet_geoid_without_control", "SBET heights above the geoid, no control", "height_geoid", chains=GIVEN,
     reason="nothing in the records knows a height of the ground")
def _(s):
    if "control" not in s.tree:
        raise NotApplicable("no control")
    del s.tree["control"]
    s.sbet()[:, COLUMN["height"]] -= UNDULATION


ATTITUDE_WORDS = r"roll or pitch reaches|angle unit|degrees|radians|roll and pitch .*swap|axes"


@each([("sbet_roll", "SBET: sign of roll", ("roll",), "roll_sign"), ("sbet_pitch", "SBET: sign of pitch", ("pitch",), "pitch_sign"),
       ("sbet_heading", "SBET: sign of heading", ("heading",), "heading_sign"), ("sbet_pitch_heading", "SBET: attitude forward, left, up",
                                                                                 ("pitch", "heading"), "axes_swapped heading_sign pitch_sign"),
       ("sbet_attitude", "SBET: signs of all angles", ("roll", "pitch", "heading"),
        "heading_sign roll_sign pitch_sign")], chains=GIVEN, cause="sign of|heading (differs|scatters)|axes")
def _(s, names):
    for name in names:
        s.sbet()[:, COLUMN[name]] *= -1


@add("sbet_grid_north", "SBET: heading from grid north", "heading_grid_north", chains=GIVEN, cause="grid north")
def _(s):
    s.sbet()[:, COLUMN["heading"]] -= convergence(s)


@each([("sbet_heading_east", "SBET: heading counter-clockwise from east", lambda h: np.pi / 2 - h, "axes_swapped heading_sign"),
       ("sbet_heading_90", "SBET: heading 90 deg off", lambda h: h + np.pi / 2, "heading_turned axes_swapped"),
       ("sbet_heading_180", "SBET: heading 180 deg off", lambda h: h + np.pi, "heading_turned axes_swapped scan_angle_sign"),
       ("sbet_heading_magnetic", "SBET: heading from magnetic north (3.5 deg)", lambda h: h - np.radians(3.5),
        "heading_offset heading_grid_north boresight")], chains=GIVEN, cause="heading (differs|scatters)|grid north")
def _(s, change):
    s.sbet()[:, COLUMN["heading"]] = change(s.sbet("heading"))


@add("sbet_roll_pitch_degrees", "SBET: roll and pitch in degrees", "attitude_degrees", chains=GIVEN, cause=ATTITUDE_WORDS)
def _(s):
    s.sbet()[:, [COLUMN["roll"], COLUMN["pitch"]]] *= 180 / np.pi


@add("sbet_all_degrees", "SBET: all angles in degrees", "attitude_degrees", chains=GIVEN, cause="degrees|latitude|rad")
def _(s):
    s.sbet()[:, [COLUMN[n] for n in ("latitude", "longitude", "roll", "pitch", "heading")]] *= 180 / np.pi


@add("sbet_roll_pitch_swapped", "SBET: roll and pitch swapped", "axes_swapped", chains=GIVEN, cause=ATTITUDE_WORDS)
def _(s):
    s.sbet()[:, [COLUMN["roll"], COLUMN["pitch"]]] = s.sbet()[:, [COLUMN["pitch"], COLUMN["roll"]]].copy()


@add("sbet_lat_lon_swapped", "SBET: latitude and longitude swapped", "axes_swapped", chains=GIVEN, cause="latitude|longitude|area of use")
def _(s):
    s.sbet()[:, 1:3] = s.sbet()[:, 2:0:-1].copy()


@add("sbet_wander", "SBET: platform heading taken for true heading (wander angle 3 deg)", "heading_wander heading_offset heading_grid_north boresight", chains=GIVEN,
     cause="wander|heading (differs|scatters)")
def _(s):
    s.sbet()[:, [COLUMN["heading"], COLUMN["wander"]]] += np.radians(3.0)
    s["trajectory"]["wander"] = False


@each([(f"sbet_time_{t}", f"SBET times {t} s late", t, ids) for t,
       ids in ((0.01, "time_offset"), (0.1, "time_offset"), (1.0, "time_offset"), (18.0, "leap_seconds"), (-18.0, "leap_seconds"))],
      chains=GIVEN, cause=TIME_WORDS)
def _(s, seconds):
    s.sbet()[:, 0] += seconds
    s.smrmsg()[:, 0] += seconds


@add("sbet_week", "SBET a week off", "gps_week", chains=GIVEN, cause="week")
def _(s):
    s["trajectory"]["time"]["week"] += 1


@add("sbet_day_seconds", "SBET times are seconds of the day", "day_seconds gps_week", chains=GIVEN, cause=TIME_WORDS)
def _(s):
    days = 86400.0 * (s.sbet()[0, 0] // 86400)
    s.sbet()[:, 0] -= days
    s.smrmsg()[:, 0] -= days


@add("sbet_other_flight", "SBET of another flight over the same place at the same time of the week", "trajectory_other_flight", chains=GIVEN,
     cause="another flight|other flight|cover")
def _(s):
    s.sbet()
    other = np.fromfile(s.other() / "sbet.out").reshape(-1, 17)
    s.arrays[s["trajectory"]["file"]] = other
    s.arrays[s["trajectory"]["accuracy"]] = np.fromfile(s.other() / "smrmsg.out").reshape(-1, 10)
    s.changed[s["trajectory"]["accuracy"]] = lambda target: s.arrays[s["trajectory"]["accuracy"]].tofile(target)


@add("sbet_antenna", "SBET places the antenna, not the IMU", "lever_arm_sign trajectory_antenna", chains=GIVEN, cause="lever arm|antenna",
     reason="0.4 m along and across, 1.2 m of height for all lines: below the attitude's part between lines, unless control shows it")
def _(s):
    arm = [number(v) for v in s["antenna"]["lever_arm"]]
    heading = s.sbet("heading").copy()
    moved(s, arm[0] * np.cos(heading) - arm[1] * np.sin(heading), arm[0] * np.sin(heading) + arm[1] * np.cos(heading), -arm[2])


@add("sbet_datum", "SBET in another datum, 0.75 m off", chains=GIVEN, reason="a datum's shift is the same for all records, unless control shows it")
def _(s):
    moved(s, *DATUM)


@each([("sbet_sigmas_100", "smrmsg: sigmas 100 times too large", 100.0, ""), ("sbet_sigmas_small", "smrmsg: sigmas 100 times too small", 0.01, "")],
      chains=GIVEN,
      reason="sigmas state what is believed of the values; too small ones show between lines only")
def _(s, factor):
    s.smrmsg()[:, 1:] *= factor


def as_text(s, units="deg", **changes):
    table = s.sbet()
    angle = 180 / np.pi if units == "deg" else 1.0
    columns = {name: table[:, COLUMN[name]] * (1.0 if name in ("time", "height") else angle)
               for name in ("time", "latitude", "longitude", "height", "roll", "pitch", "heading")}
    spread = s.smrmsg()
    columns.update({f"sigma_{name}": spread[:, k] for k, name in enumerate(("north", "east", "down"), 1)})
    columns.update({f"sigma_{name}": spread[:, k] / 60 * (1.0 if units == "deg" else np.pi / 180) for k,
                    name in enumerate(("roll", "pitch", "heading"), 7)})
    columns.update({name: change(columns[name]) for name, change in changes.items()})
    s.text_trajectory(columns, units)
    return s["trajectory"]


@add("text_degrees_as_radians", "trajectory text: degrees stated as radians", "attitude_degrees", chains=GIVEN, cause="latitude|degrees|rad")
def _(s):
    as_text(s)["angle_unit"] = "rad"


@add("text_attitude_radians", "trajectory text: attitude in radians beside places in degrees", "attitude_radians", chains=GIVEN, cause=ATTITUDE_WORDS)
def _(s):
    as_text(s, **{name: np.radians for name in ("roll", "pitch", "heading")})


@add("text_lat_lon_swapped", "trajectory text: columns of latitude and longitude swapped", "axes_swapped", chains=GIVEN,
     cause="latitude|longitude|area of use")
def _(s):
    columns = as_text(s)["columns"]
    columns["latitude"], columns["longitude"] = "longitude", "latitude"


def projected(s):
    """UTM northing and easting of the SBET to 1 mm (Karney 2011, order 4)."""
    code = int(s.tree["crs"].removeprefix("EPSG:"))
    convergence(s)  # UTM alone
    latitude, longitude = s.sbet("latitude"), s.sbet("longitude") - np.radians(6 * (code % 100) - 183)
    n = 1 / 298.257223563 / (2 - 1 / 298.257223563)
    alpha = (n / 2 - 2 / 3 * n**2 + 5 / 16 * n**3, 13 / 48 * n**2 - 3 / 5 * n**3, 61 / 240 * n**3)
    e = np.sqrt(E2)
    conformal = np.sinh(np.arctanh(np.sin(latitude)) - e * np.arctanh(e * np.sin(latitude)))
    xi, eta = np.arctan2(conformal, np.cos(longitude)), np.arcsinh(np.sin(longitude) / np.hypot(conformal, np.cos(longitude)))
    x, y = xi.copy(), eta.copy()
    for k, a in enumerate(alpha, 1):
        x += a * np.sin(2 * k * xi) * np.cosh(2 * k * eta)
        y += a * np.cos(2 * k * xi) * np.sinh(2 * k * eta)
    scale = 0.9996 * A / (1 + n) * (1 + n**2 / 4 + n**4 / 64)
    return scale * x + (1e7 if code // 100 == 327 else 0.0), scale * y + 5e5


@each([("utm_right", "trajectory text in UTM, rightly stated", {}, "", {"reason": "no mistake: the text form itself"}),
       ("utm_zone", "trajectory text: UTM zone one too far east", {"zone": 1}, "wrong_zone heading_grid_north"),
       ("utm_hemisphere", "trajectory text: UTM of the southern hemisphere", {"zone": 100}, "wrong_hemisphere"),
       ("utm_swapped", "trajectory text: easting and northing swapped", {"swap": True}, "axes_swapped"),
       ("utm_grid_north", "trajectory text in UTM with headings from grid north", {"grid": True}, "heading_grid_north")], chains=GIVEN,
      cause=r"\bcrs|zone|area of use|easting|northing|grid north|heading differs")
def _(s, mistake):
    north, east = projected(s)
    grid = np.degrees(convergence(s)) if mistake.get("grid") else 0.0
    t = as_text(s, latitude=lambda _: north, longitude=lambda _: east, heading=lambda h: h - grid)
    t["crs"] = f"EPSG:{int(s.tree['crs'].removeprefix('EPSG:')) + mistake.get('zone', 0)}"
    if mistake.get("swap"):
        t["columns"].update(latitude="longitude", longitude="latitude")
