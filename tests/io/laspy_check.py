# SPDX-License-Identifier: GPL-3.0-or-later
"""Holds our LAS and LAZ files against laspy + lazrs, both ways and field by field.

laspy_check.py LAS_SAMPLES FOLDER   (run by the Python of laspy_environment.py)
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

samples, folder = sys.argv[1], pathlib.Path(sys.argv[2])
NODATA = "type4", -32768  # as las_samples writes it
faults = []
compared = 0


def same(where, ours, theirs):
    global compared
    compared += 1
    theirs = np.asarray(theirs)
    if len(ours) != len(theirs) or not np.array_equal(ours, theirs, equal_nan=ours.dtype.kind == "f"):
        bad = "lengths" if len(ours) != len(theirs) else f"{np.count_nonzero(ours != theirs)} of {len(ours)} values"
        faults.append(f"{where}: {bad} differ: {ours[:3]} {theirs[:3]}")


def columns_of(directory):
    return {f.stem: np.fromfile(f, dtype="<" + f.suffix[1:]) for f in sorted(directory.iterdir())}


def compare(where, las, columns):
    """Every column of ours is in laspy's file, and every field of laspy's file is in our columns."""
    standard = [n for n in columns if n != "extra" and not n.startswith("extra_")]
    for name in standard:
        if name in "xyz":  # laspy scales with the same two operations
            same(f"{where} {name}", columns[name], las[name])
        else:
            same(f"{where} {name}", columns[name], np.asarray(las[name], dtype=columns[name].dtype))
    unknown = set(las.point_format.standard_dimension_names) - set(standard)
    if unknown:
        faults.append(f"{where}: fields without a column of ours: {unknown}")
    for dimension in las.point_format.extra_dimensions:
        name = dimension.name
        if dimension.num_elements == 1:
            raw = las.points.array[name].astype("f8")
            values = np.array(las[name], dtype="f8")
            if name == NODATA[0]:  # laspy does not apply it
                values[raw == NODATA[1]] = np.nan
            same(f"{where} extra {name}", columns["extra_" + name], values)
    if len(las.points):
        fields = [las.points.array[d.name] for d in las.point_format.extra_dimensions]
        extra = [np.ascontiguousarray(f).view("u1").reshape(len(las.points), -1) for f in fields]
        same(f"{where} extra bytes", columns["extra"], np.hstack(extra).ravel() if extra else np.zeros(0, "u1"))


def ours_read_by_laspy():
    subprocess.run([samples, "write", str(folder)], check=True)
    files = sorted(f for f in folder.iterdir() if f.suffix in (".las", ".laz"))
    assert len(files) == 11 * 2 * 3 + 2, len(files)
    for file in files:
        las = laspy.read(file)
        columns = columns_of(folder / (file.name + ".columns"))
        compare(f"ours {file.name}", las, columns)
        header = las.header
        n = len(columns["X"])
        if header.point_count != n:
            faults.append(f"ours {file.name}: {header.point_count} points counted, {n} written")
        if n:
            same(f"ours {file.name} minimum", np.array([columns[k].min() for k in "xyz"]), header.mins)
            same(f"ours {file.name} maximum", np.array([columns[k].max() for k in "xyz"]), header.maxs)
            bins = 15 if header.version.minor >= 4 else 5
            returns = np.bincount(columns["return_number"], minlength=bins + 1)[1 : bins + 1]
            same(f"ours {file.name} by return", returns, header.number_of_points_by_return[:bins])


def laspys_read_by_us():
    random = np.random.default_rng(5)
    for point_format in range(11):
        for ending in ("las", "laz"):
            for n in (0, 1, 3000, 2**20 + 1):
                if n > 3000 and (point_format, ending) != (7, "laz"):
                    continue
                header = laspy.LasHeader(point_format=point_format, version="1.4")
                header.scales, header.offsets = [0.01, 0.001, 0.0025], [5e5, 5.4e6, -100.0]
                if n <= 3000:
                    for kind in ("u1", "i1", "u2", "i2", "u4", "i4", "u8", "i8", "f4", "f8"):
                        header.add_extra_dim(laspy.ExtraBytesParams(name="e" + kind, type=kind))
                    header.add_extra_dim(laspy.ExtraBytesParams(name="scaled", type="i2", scales=np.array([0.01]), offsets=np.array([7.0])))
                    header.add_extra_dim(laspy.ExtraBytesParams(name="three", type="3u2"))
                las = laspy.LasData(header)
                las.points = laspy.ScaleAwarePointRecord.zeros(n, header=header)
                for dimension in las.point_format.dimensions:
                    name, bits = dimension.name, dimension.num_bits
                    if dimension.num_elements > 1:
                        las.points.array[name] = random.integers(0, 65536, (n, dimension.num_elements))
                    elif dimension.kind == laspy.DimensionKind.FloatingPoint:
                        las.points.array[name] = np.cumsum(random.integers(0, 100, n)) * 0.25
                    elif dimension.kind == laspy.DimensionKind.BitField:
                        las[name] = random.integers(0, 2**bits, n)
                    elif dimension.kind == laspy.DimensionKind.SignedInteger:
                        low, high = (-30000, 30001) if name == "scan_angle" else (-90, 91) if name == "scan_angle_rank" else (-2**(bits - 1), 2**(bits - 1))
                        las.points.array[name] = random.integers(low, high, n, dtype="i8")
                    else:
                        las.points.array[name] = random.integers(0, 2**bits, n, dtype="u8")
                file = folder / f"laspy{point_format}_{n}.{ending}"
                las.write(file)
                out = folder / (file.name + ".columns")
                done = subprocess.run([samples, "dump", str(file), str(out)], text=True, stderr=subprocess.PIPE)
                if done.returncode:
                    faults.append(f"laspy's {file.name}: {done.stderr}")
                    continue
                compare(f"laspy's {file.name}", laspy.read(file), columns_of(out))


shutil.rmtree(folder, ignore_errors=True)
folder.mkdir(parents=True)
ours_read_by_laspy()
laspys_read_by_us()
shutil.rmtree(folder, ignore_errors=True)
print(f"laspy {laspy.__version__}: {compared} columns compared, {len(faults)} faults")
print("\n".join(faults[:40]))
sys.exit(1 if faults or compared < 2000 else 0)
