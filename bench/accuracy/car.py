# SPDX-License-Identifier: GPL-3.0-or-later
"""A drive with a MEMS IMU (100 Hz) and RTK (4 Hz): fixes withheld ten times for 15 s and for 30 s, and found again by the smoother and by interpolation: car.py [SETTING ...]

The settings are those of SETTINGS. The file's velocities lag behind its positions by 0.13 s (printed first), and the offset of the IMU's clock that its makers
state ("as stated") fits the velocities; "positions" has the offset at which the gyros' turn rate fits that of the positions, and leaves the velocities out.
"walks" are white noises of the IMU in deg/sqrt(h) and m/s/sqrt(h): a car shakes more than a data sheet says. A setting that is refused is not tried further."""
import datetime
import sys

import numpy as np
from scipy.interpolate import CubicHermiteSpline, CubicSpline

import common
import navigation

SURVEY = """name = "drive"
crs = "EPSG:32613"

[[imu]]
file = "{data}/imu_1934.csv"
time = {{ scale = "device", unit = "1 ms", origin = "2025-07-08T19:34:21.985 GPS", origin_at = 261906, offset = "{offset} s" }}
kind = "rates"
angle_unit = "deg"
acceleration_unit = "g"
axes = ["-x", "y", "-z"]
roll = "-0.636 deg"
pitch = "-6.760 deg"
heading = "5.388 deg"
columns = {{ time = "7", gyro_x = "4", gyro_y = "5", gyro_z = "6", accelerometer_x = "1", accelerometer_y = "2", accelerometer_z = "3" }}

[imu_spec]
{spec}

[[gnss]]
file = "{fixes}"

[antenna]
lever_arm = ["0 m", "-0.05 m", "0 m"]
"""
GRADE = 'grade = "{}"'
WALKS = GRADE.format("consumer") + '\nangular_random_walk = "{} deg/sqrt(h)"\nvelocity_random_walk = "{} m/s/sqrt(h)"'
POSITIONS = {"ins_gnss__use_velocity": "false"}
WHEELS = {"ins_gnss__non_holonomic": "true"}
SETTINGS = {  # offset of the IMU's clock s, imu_spec, options
    "mems, as stated": (-0.125, GRADE.format("mems"), {}),
    "consumer, as stated": (-0.125, GRADE.format("consumer"), {}),
    "consumer, positions": (-0.245, GRADE.format("consumer"), POSITIONS),
    "walks 2 and 1, positions": (-0.245, WALKS.format(2, 1), POSITIONS),
    "walks 5 and 3, positions": (-0.245, WALKS.format(5, 3), POSITIONS),
}
STRETCHES = 10
EDGE = 30  # s that are kept at the beginning and the end of the records
GPS_EPOCH = datetime.datetime(1980, 1, 6)


def read_pos(file):
    """Header lines, record lines, GPS seconds, latitude longitude (rad) height, quality, velocity north east up of an RTKLIB file."""
    lines = file.read_text().splitlines()
    header, records = [s for s in lines if s.startswith("%")], [s for s in lines if s and not s.startswith("%")]
    words = [s.split() for s in records]
    time = np.array([(datetime.datetime.strptime(f"{w[0]} {w[1]}", "%Y/%m/%d %H:%M:%S.%f") - GPS_EPOCH).total_seconds() for w in words])
    values = np.array([[float(v) for v in w[2:]] for w in words])
    return header, records, time, np.c_[np.radians(values[:, :2]), values[:, 2]], values[:, 3].round(), values[:, 13:16]


def smoothed_antenna(output, lever):
    """GPS seconds, antenna latitude longitude (rad) height and sigmas of trajectory.csv, with the lever arm that the smoother estimated."""
    t = np.loadtxt(output / "trajectory.csv", delimiter=",", skiprows=1)
    roll, pitch, yaw = np.radians(t[:, 5:8]).T
    x, y, z = lever
    across = np.cos(roll) * y - np.sin(roll) * z
    down = np.sin(roll) * y + np.cos(roll) * z
    forward, down = np.cos(pitch) * x + np.sin(pitch) * down, -np.sin(pitch) * x + np.cos(pitch) * down
    lat, lon, h = np.radians(t[:, 2]), np.radians(t[:, 3]), t[:, 4]
    north, east = navigation.radii(lat, h)
    lat = lat + (np.cos(yaw) * forward - np.sin(yaw) * across) / north
    lon = lon + (np.sin(yaw) * forward + np.cos(yaw) * across) / east
    return t[:, 0] * 604800 + t[:, 1], np.c_[lat, lon, h - down], t[:, 11:14]


def local(place, about):
    north, east = navigation.radii(about[0], about[2])
    return np.c_[(place[:, 0] - about[0]) * north, (place[:, 1] - about[1]) * east, about[2] - place[:, 2]]


def smooth(setting, wheels, kept):
    """Report, antenna and sigmas of one run, or its error."""
    offset, spec, options = SETTINGS[setting]
    name = "run"
    fixes = folder / f"{name}.pos"
    fixes.write_text("\n".join(header + [s for s, k in zip(records, kept) if k]) + "\n")
    survey = folder / f"{name}.toml"
    survey.write_text(SURVEY.format(data=data, offset=offset, spec=spec, fixes=fixes))
    output = folder / name
    try:
        common.run(common.ROOT / "configs/trajectory.toml", survey, output, ins_gnss__plots="[]", trajectory__formats='["text"]', **options, **(WHEELS if wheels else {}))
    except SystemExit as refusal:  # a stated grade that the records contradict is an error
        return [line for line in str(refusal).splitlines() if "error:" in line][0]
    report = navigation.findings(output)
    return report, *smoothed_antenna(output, report["estimates"]["lever_arm"]["value"])


def interpolated(antenna, time):
    return np.stack([np.interp(time, antenna[0], c) for c in antenna[1].T], axis=1)


def cells(error, stretch):
    """Horizontal rms and maximum, the median over stretches of their largest error, rms of height."""
    flat = np.hypot(error[:, 0], error[:, 1])
    worst = [flat[stretch == i].max() for i in range(STRETCHES)]
    return [f"{common.rms(flat):.2f}", f"{flat.max():.2f}", f"{np.median(worst):.2f}", f"{common.rms(error[:, 2]):.2f}"]


data = common.reference("car_imu_rtk", "drive_0708")
folder = common.scratch("car")
header, records, time, place, quality, speed = read_pos(data / "gnss_1934_sf.pos")
ground = local(place, place[0])
imu = np.loadtxt(data / "imu_1934.csv", delimiter=",", usecols=6)
origin = (datetime.datetime(2025, 7, 8, 19, 34, 21, 985000) - GPS_EPOCH).total_seconds() - 0.125
first, last = origin, origin + (imu[-1] - imu[0]) / 1000
settings = sys.argv[1:] or list(SETTINGS)
everything = np.ones(len(time), bool)

by_positions = np.gradient(ground[:, :2], time, axis=0)
lags = np.arange(-0.1, 0.35, 0.005)
apart = [common.rms(np.stack([np.interp(time + lag, time, v) for v in speed[:, :2].T], axis=1) - by_positions, axis=None) for lag in lags]
course = np.unwrap(np.arctan2(by_positions[:, 1], by_positions[:, 0]))
rate = np.degrees(np.gradient(course, time))
sharp = np.loadtxt(data / "imu_1934.csv", delimiter=",")
clock = first + 0.125 + (imu - imu[0]) / 1000
turn = np.convolve(-sharp[:, 5], np.full(50, 0.02), "same")
moving = (np.hypot(*by_positions.T) > 3) & (np.abs(rate) < 60) & (time > clock[0] + 2) & (time < clock[-1] - 2)
shifts = np.arange(-0.5, 0.2, 0.005)
fits = [np.std(np.interp(time[moving] - shift, clock, turn) - rate[moving]) for shift in shifts]
print(f"velocities lag behind the positions by {lags[np.argmin(apart)]:.3f} s ({min(apart):.3f} m/s rms apart then); "
      f"turn rates fit those of the positions with an offset of {shifts[np.argmin(fits)]:+.3f} s ({min(fits):.2f} deg/s)\n", flush=True)

rows, told, refused = [], [], set()
for setting in settings:
    for wheels in (False, True):
        result = smooth(setting, wheels, everything)
        if isinstance(result, str):
            rows.append([setting, "yes" if wheels else "no", *[""] * 7, result.split("ins_gnss: ")[-1]])
            refused.add(setting)
            continue
        report, t, antenna, sigma = result
        near = (time > t[0]) & (time < t[-1])
        difference = interpolated((t, local(antenna, place[0])), time[near]) - ground[near]
        found = report["innovations"]
        rows.append([setting, "yes" if wheels else "no", report["alignment"]["method"], f"{report['standstill_s']:.0f}", f"{found['mean_nis']:.2f}", 
                     f"{report['fixes']['correlated_share']:.2f}", f"{report['fixes']['variance_factor']:.2f}", report["fixes"]["down_weighted"],
                     " ".join(f"{100 * v:.1f}" for v in common.rms(difference)), len(report["warnings"])])
        told += [[setting, "yes" if wheels else "no", w] for w in report["warnings"]]
common.table(["setting", "non-holonomic", "alignment", "standstill s", "NIS (3)", "correlated share", "variance factor", "down-weighted", 
              "smoothed minus fixes rms N E D cm", "warnings"], rows)
common.table(["setting", "non-holonomic", "warning"], told)

rows = []
for length in (15, 30):
    room = (last - first - 2 * EDGE) / STRETCHES
    starts = first + EDGE + room * np.arange(STRETCHES) + 0.5 * (room - length)
    stretch = np.full(len(time), -1)
    for i, start in enumerate(starts):
        stretch[(time >= start) & (time < start + length)] = i
    kept = stretch < 0
    judged = ~kept & (quality == 1)
    moved = [np.hypot(*np.ptp(ground[stretch == i, :2], axis=0)) for i in range(STRETCHES)]
    print(f"{length} s: {judged.sum()} fixes withheld, extent of the stretches m: " + " ".join(f"{m:.0f}" for m in moved), flush=True)
    sure = kept & (quality == 1)
    for name, curve in (("linear interpolation", lambda t: np.stack([np.interp(t, time[sure], c) for c in ground[sure].T], axis=1)),
                        ("cubic spline", CubicSpline(time[sure], ground[sure])),
                        ("cubic Hermite with the fixes' velocities", CubicHermiteSpline(time[sure], ground[sure], speed[sure] * [1, 1, -1]))):
        rows.append([length, name, *cells(curve(time[judged]) - ground[judged], stretch[judged]), "", "", ""])
    for setting in [s for s in settings if s not in refused]:
        for wheels in (False, True):
            result = smooth(setting, wheels, kept)
            method = f"smoother, {setting}" + (", non-holonomic" if wheels else "")
            if isinstance(result, str):
                rows.append([length, method, *[""] * 6, result])
                continue
            report, t, antenna, sigma = result
            error = interpolated((t, local(antenna, place[0])), time[judged]) - ground[judged]
            ratio = common.rms(error / interpolated((t, sigma), time[judged]))
            rows.append([length, method, *cells(error, stretch[judged]), " ".join(f"{v:.2f}" for v in ratio),
                         f"{report['innovations']['mean_nis']:.2f}", len(report["warnings"])])
common.table(["withheld s", "by", "horizontal rms m", "maximum m", "median of the stretches' maxima m", "height rms m", "error/sigma N E D", "NIS", "warnings"], rows)
