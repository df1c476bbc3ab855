# SPDX-License-Identifier: GPL-3.0-or-later
"""Holds our COPC files against laspy.CopcReader and, where npm can install it, copc.js: field by field.

copc_check.py LAS_SAMPLES FOLDER COPCJS_SOURCE   (run by the Python of laspy_environment.py)
"""
import pathlib
import shutil
import subprocess
import sys

try:
    import laspy
    import numpy as np
except ImportError as missing:
    print(f"SKIPPED: {missing}; the environment could not be made")
    sys.exit(77)

samples, folder, copcjs = sys.argv[1], pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3])
NODATA = "type4", -32768  # as las_samples writes it
COPCJS_NAMES = {"X": "x", "Y": "y", "Z": "z", "Intensity": "intensity", "ReturnNumber": "return_number", "NumberOfReturns": "number_of_returns",
                "ScanDirectionFlag": "scan_direction_flag", "EdgeOfFlightLine": "edge_of_flight_line", "Classification": "classification",
                "Synthetic": "synthetic", "KeyPoint": "key_point", "Withheld": "withheld", "Overlap": "overlap", "ScannerChannel": "scanner_channel",
                "ScanChannel": "scanner_channel", "UserData": "user_data", "PointSourceId": "point_source_id", "GpsTime": "gps_time",
                "Red": "red", "Green": "green", "Blue": "blue", "Infrared": "nir", "ScanAngle": "scan_angle"}
faults = []
compared = 0


def same(where, ours, theirs, tolerance=0.0):
    global compared
    compared += 1
    ours, theirs = np.asarray(ours, dtype="f8"), np.asarray(theirs, dtype="f8")
    good = len(ours) == len(theirs) and (np.isnan(ours) == np.isnan(theirs)).all()
    if not good or not (np.nan_to_num(np.abs(ours - theirs)) <= tolerance).all():
        faults.append(f"{where}: {len(ours)} and {len(theirs)} values differ: {ours[:3]} {theirs[:3]}")


def columns_of(directory):
    """Our columns in the order of time, which is different for every point."""
    columns = {f.stem: np.fromfile(f, dtype="<" + f.suffix[1:]) for f in directory.iterdir() if f.stem != "extra"}
    order = np.argsort(columns["gps_time"])
    assert len(np.unique(columns["gps_time"])) == len(order)
    return {name: column[order] for name, column in columns.items()}


def by_laspy(file, columns):
    with laspy.CopcReader.open(str(file)) as reader:
        header, info = reader.header, reader.copc_info
        points = reader.query()
        order = np.argsort(points["gps_time"])
        n = len(columns["gps_time"])
        if len(points) != n or header.point_count != n:
            faults.append(f"{file.name}: {len(points)} points read, {header.point_count} counted, {n} written")
            return
        for name, ours in columns.items():
            if name.startswith("extra_"):
                theirs = np.array(points[name[6:]], dtype="f8")
                if name[6:] == NODATA[0] and "float" not in file.name:  # laspy does not apply it
                    theirs[points.array[NODATA[0]] == NODATA[1]] = np.nan
            else:
                theirs = np.asarray(points[name])
            same(f"laspy {file.name} {name}", ours, theirs[order], 5e-5 if "float" in file.name and name == "extra_type4" else 0.0)
        same(f"laspy {file.name} times", [columns["gps_time"].min(), columns["gps_time"].max()], [info.gps_min, info.gps_max])
        # A part of it, and a coarser one.
        middle = [np.median(columns[k]) for k in "xy"]
        box = laspy.Bounds(mins=np.array([middle[0], middle[1]]), maxs=np.array([middle[0] + 100, middle[1] + 70]))
        part = reader.query(bounds=box)
        inside = (columns["x"] >= box.mins[0]) & (columns["x"] <= box.maxs[0]) & (columns["y"] >= box.mins[1]) & (columns["y"] <= box.maxs[1])
        same(f"laspy {file.name} times within bounds", columns["gps_time"][inside], np.sort(part["gps_time"]))
        coarse = reader.query(level=0)
        if not 0 < len(coarse) < n:
            faults.append(f"{file.name}: {len(coarse)} of {n} points on the first level")
    whole = laspy.read(str(file))  # as a plain LAZ file
    same(f"laspy {file.name} as LAZ", columns["gps_time"], np.sort(whole["gps_time"]))


def by_copcjs(file, columns):
    out = folder / (file.name + ".js")
    done = subprocess.run(["node", str(folder / "copcjs" / "dump.cjs"), str(file), str(out)], text=True, stderr=subprocess.PIPE)
    if done.returncode:
        faults.append(f"copc.js {file.name}: {done.stderr[:500]}")
        return
    theirs = {f.stem: np.fromfile(f, dtype="<f8") for f in out.iterdir()}
    order = np.argsort(theirs["GpsTime"])
    read = set()
    for name, values in theirs.items():
        ours = COPCJS_NAMES.get(name, "extra_" + name)
        if ours not in columns:
            continue  # made of others: ClassFlags
        read.add(ours)
        if ours == "scan_angle":
            same(f"copc.js {file.name} {name}", columns[ours] * 0.006, values[order], 1e-9)
        elif ours == "extra_" + NODATA[0] and "float" not in file.name:
            continue  # copc.js 0.0.8 reads scale and offset big-endian: what extra_bytes = "float" is for
        else:
            same(f"copc.js {file.name} {name}", columns[ours], values[order], 5e-5 if ours == "extra_" + NODATA[0] else 0.0)
    missing = set(columns) - read - {"X", "Y", "Z", "synthetic", "key_point", "withheld", "overlap"}
    if missing:
        faults.append(f"copc.js {file.name}: fields that it does not give: {missing}")


def has_copcjs():
    (folder / "copcjs").mkdir()
    for name in ("package.json", "package-lock.json", "dump.cjs"):
        shutil.copy(copcjs / name, folder / "copcjs")
    try:
        done = subprocess.run(["npm", "ci", "--no-audit", "--no-fund"], cwd=folder / "copcjs", text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    except FileNotFoundError:
        print("copc.js is left out: no npm here")
        return False
    if done.returncode:
        print(f"copc.js is left out: {done.stdout[-300:]}")
    return done.returncode == 0


shutil.rmtree(folder, ignore_errors=True)
folder.mkdir(parents=True)
subprocess.run([samples, "copc", str(folder)], check=True)
files = sorted(folder.glob("*.copc.laz"))
assert len(files) == 6, files
with_js = has_copcjs()
for file in files:
    columns = columns_of(folder / (file.name + ".columns"))
    by_laspy(file, columns)
    if with_js:
        by_copcjs(file, columns)
shutil.rmtree(folder, ignore_errors=True)
print(f"laspy {laspy.__version__}{', copc.js' if with_js else ''}: {compared} columns compared, {len(faults)} faults")
print("\n".join(faults[:40]))
sys.exit(1 if faults or compared < 150 else 0)
