# SPDX-License-Identifier: GPL-3.0-or-later
"""readers.las -> writers.las on every LAS and LAZ file of the reference data and on made files: which fields differ, by laspy.

    roundtrip.py [NAME ...] [--tile LENGTH]

NAME: a part of a file's name; none: all. --tile: tiles of this length; the points are then compared in an order of their own.
A file without a CRS (or with one that is no map projection) is given one in its survey: its output has a WKT record more.
"""
import argparse
import sys
import tomllib
import uuid
from datetime import date
from pathlib import Path

import laspy
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "accuracy"))
import common

WIDEST = "100 km"  # what the program takes
STAND_IN = "EPSG:32632"  # for files without a usable CRS: nothing is computed in it
CRS = {("LASF_Projection", n) for n in (2111, 2112, 34735, 34736, 34737)}
MADE = 2000  # points of a made file
EXTRA = ["u1", "i1", "u2", "i2", "u4", "i4", "u8", "i8", "f4", "f8", "2u2", "3i4", "3f8", "5u1"]


def made_file(folder, point_format, ending):
    random = np.random.default_rng(100 + point_format)
    version = "1.4" if point_format >= 6 or point_format % 2 else "1.3" if point_format >= 4 else "1.2"
    header = laspy.LasHeader(point_format=point_format, version=version)
    header.scales, header.offsets = [0.0001, 0.0002, 0.0005], [5.5e5, 5.45e6, -100.0]
    header.creation_date, header.uuid, header.file_source_id = date(2013, 4, 5), uuid.uuid4(), 321
    header.system_identifier = "OTHER"
    header.vlrs.append(laspy.VLR(user_id="vendor", record_id=7, description="odd", record_data=bytes(range(256))))
    header.vlrs.append(laspy.VLR(user_id="vendor", record_id=7, description="same again", record_data=b""))
    for k, kind in enumerate(EXTRA):
        if kind[0].isdigit():
            header.add_extra_dim(laspy.ExtraBytesParams(name=f"e{kind}", type=kind, description="vector"))
        else:
            header.add_extra_dim(laspy.ExtraBytesParams(name=f"e{kind}", type=kind, description="made", scales=np.array([0.5]) if k % 2 and kind[0] != "f" else None,
                                                        offsets=np.array([7.0]) if k % 2 and kind[0] != "f" else None, no_data=[np.array(3, kind)] if k % 3 == 0 else None))
    las = laspy.LasData(header)
    las.points = laspy.ScaleAwarePointRecord.zeros(MADE, header=header)
    array = las.points.array
    for name in array.dtype.names:  # every bit of the records, return numbers of 0 and all flags with them
        array[name] = np.frombuffer(random.bytes(array[name].nbytes), array[name].dtype).reshape(array[name].shape)
    for name in ("X", "Y", "Z"):
        array[name] //= 16
    if point_format < 6:
        array["scan_angle_rank"] = random.integers(-90, 91, MADE)
    else:
        array["scan_angle"] = random.integers(-30000, 30001, MADE)
    if "gps_time" in array.dtype.names:
        array["gps_time"] = np.cumsum(random.random(MADE)) + (3e8 if point_format % 3 else 0)
        header.global_encoding.gps_time_type = laspy.header.GpsTimeType.STANDARD if point_format % 3 == 1 else laspy.header.GpsTimeType.WEEK_TIME
    if version == "1.4":
        las.evlrs = laspy.vlrs.vlrlist.VLRList([laspy.VLR(user_id="vendor", record_id=9, description="long", record_data=random.bytes(70000))])
    file = folder / f"made_format{point_format}.{ending}"
    las.write(str(file))
    return file


def record(vlr):
    data = vlr.record_data_bytes() if hasattr(vlr, "record_data_bytes") else vlr.record_data
    return vlr.user_id, vlr.record_id, vlr.description.rstrip("\0"), bytes(data)


def records(las, kind):
    return [record(v) for v in (getattr(las, kind, None) or []) if v.user_id != "laszip encoded"]


def faults_of(before, after, crs_given):
    """Names of what differs between two files (`after` may be several: tiles)."""
    a, b = before.header, after[0].header
    out = []
    expected = {name: getattr(a, name) for name in ("point_format", "uuid", "creation_date", "file_source_id", "system_identifier")}
    out += [name for name, value in expected.items() if value != getattr(b, name)]
    if not crs_given and a.version != b.version:
        out.append("version")
    if not np.array_equal(a.scales, b.scales) or not np.array_equal(a.offsets, b.offsets):
        out.append("scale or offset")
    wkt = 16 if crs_given else 0
    if (a.global_encoding.value | wkt) != (b.global_encoding.value | wkt):
        out.append(f"global encoding {a.global_encoding.value} {b.global_encoding.value}")
    for kind in ("vlrs", "evlrs"):
        mine, theirs = records(before, kind), records(after[0], kind)
        if crs_given:
            mine, theirs = ([r for r in rs if r[:2] not in CRS] for rs in (mine, theirs))
        if mine != theirs:
            out.append(f"{kind}: {[r[:2] + (len(r[3]),) for r in mine]} {[r[:2] + (len(r[3]),) for r in theirs]}")
    one, other = before.points.array, np.concatenate([f.points.array for f in after])
    if one.dtype != other.dtype or len(one) != len(other):
        return [*out, f"fields or number of points: {len(one)} {len(other)}"]
    if len(after) > 1:
        one, other = (np.sort(np.ascontiguousarray(x).view(f"S{x.dtype.itemsize}"), kind="stable") for x in (one, other))
        return out + (["points"] if not np.array_equal(one, other) else [])
    for name in one.dtype.names:
        differ = np.count_nonzero((np.ascontiguousarray(one[name]).view("u1") != np.ascontiguousarray(other[name]).view("u1")).reshape(len(one), -1).any(axis=1))
        if differ:
            out.append(f"{name} of {differ} points")
    return out


def round_trip(file, folder, tile):
    folder.mkdir(parents=True, exist_ok=True)
    survey = folder / "survey.toml"
    stages = [{"type": "readers.las"}, {"type": "writers.las", "compress": file.suffix == ".laz"}]
    crs_given = False
    for crs in ("", f'crs = "{STAND_IN}"\n'):
        crs_given = bool(crs)
        survey.write_text(f'{crs}[[points]]\nfile = "{file}"\n{crs}')
        try:
            report = common.run(stages, survey, folder / "out", run__tile=tile)
            break
        except SystemExit as refused:
            if crs_given:
                return [f"refused: {refused}"], crs_given, {}
    after = [laspy.read(f) for f in sorted((folder / "out/points").glob(f"*{file.suffix}"))]
    return faults_of(laspy.read(file), after, crs_given), crs_given, report


def main():
    given = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    given.add_argument("names", nargs="*")
    given.add_argument("--tile", default=WIDEST)
    given = given.parse_args()
    scratch = common.scratch("real/roundtrip")
    (scratch / "made").mkdir()
    files = sorted(f for f in common.reference().rglob("*") if f.suffix in (".las", ".laz"))
    files += [made_file(scratch / "made", point_format, ending) for point_format in range(11) for ending in ("las", "laz")]
    failed = 0
    for k, file in enumerate(f for f in files if not given.names or any(n in f.name for n in given.names)):
        faults, crs_given, report = round_trip(file, scratch / str(k), given.tile)
        failed += bool(faults)
        print(f"{file.name:52} {'WKT added, ' if crs_given else ''}{'; '.join(faults) or 'every field equal'}", flush=True)
        for one in report.get("stages", []):
            for what, how in one.get("tally", {}).items():
                if "contradict" in what or "not carried" in what:
                    print(f"    {what}: {how.get('examples', how)}")
    print(f"{failed} files differ")
    sys.exit(failed > 0)


if __name__ == "__main__":
    main()
