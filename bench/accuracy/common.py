# SPDX-License-Identifier: GPL-3.0-or-later
"""What the accuracy scripts share: where things lie, runs of the program, its products read by independent readers."""
import json
import os
import pathlib
import re
import shutil
import sqlite3
import struct
import subprocess
import sys

import laspy
import numpy as np
import rasterio

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCRATCH = pathlib.Path(os.environ.get("SWATH_SCRATCH", ROOT / "out/accuracy"))
OUTLIERS = (7, 18)


def program():
    """The program: $SWATH, or the release build's."""
    path = pathlib.Path(os.environ.get("SWATH", ROOT / "build/release/tools/swath"))
    if not path.exists():
        sys.exit(f"{path} is missing: cmake --preset release && cmake --build build/release, or set SWATH")
    return path


def reference(*parts):
    """A folder of the reference data beside the checkout; ends the script where it is absent."""
    path = pathlib.Path(os.environ.get("SWATH_SHARED", ROOT.parent / "shared")).joinpath("data", *parts)
    if not path.exists():
        sys.exit(f"no reference data at {path}: set SWATH_SHARED to the folder that holds data/")
    return path


def scratch(name):
    folder = SCRATCH / name
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    return folder


def sets(options):
    return [word for key, value in options.items() for word in ("--set", f"{key}={value}")]


def call(*words):
    # Another build may make the surveys: $SWATH_SIMULATE.
    by = os.environ.get("SWATH_SIMULATE", program()) if words[0] == "simulate" else program()
    done = subprocess.run([by, *map(str, words)], text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    if done.returncode:
        sys.exit(f"swath {' '.join(map(str, words))}\n{done.stdout}{done.stderr}")


def simulate(folder, **options):
    """`swath simulate`; option names have two underscores for the dot."""
    call("simulate", folder, "--quiet", *sets({k.replace("__", "."): v for k, v in options.items()}))
    return folder


def run(config, survey, output, **options):
    """`swath run`; `config` is a file, or the list of stages of one that is written here. Returns report.json."""
    if isinstance(config, list):
        text = "".join("[[stage]]\n" + "".join(f"{k} = {toml(v)}\n" for k, v in stage.items()) + "\n" for stage in config)
        config = output.parent / f"{output.name}.toml"
        config.write_text(text)
    call("run", config, "--survey", survey, "--output", output, "--quiet", *sets({k.replace("__", "."): v for k, v in options.items()}))
    return json.loads((output / "report.json").read_text())


def toml(value):
    if isinstance(value, bool):
        return "true" if value else "false"
    return json.dumps(value)


def listing(*words):
    return subprocess.run([program(), *words], text=True, check=True, stdout=subprocess.PIPE).stdout


def ground_filters():
    """Every ground filter of the program: the filters whose sentence begins so."""
    lines = (line.split(maxsplit=1) for line in listing("stages").splitlines())
    return [name for name, sentence in lines if name.startswith("filters.") and sentence.startswith("Ground points")]


def ground_chains(names=None, noise=True):
    """The one list of chains that ground.py and isprs.py judge: every ground filter with its defaults, alone and (`noise`) behind filters.noise."""
    chains = {}
    for name in names or ground_filters():
        short = name.removeprefix("filters.")
        chains[short] = [{"type": name}]
        if noise:
            chains[f"noise + {short}"] = [{"type": "filters.noise"}, {"type": name}]
    return chains


def agreement(is_ground, said):
    """Type I, II, total error and kappa in percent (Sithole and Vosselman 2004); NaN where a side is empty."""
    lost, taken, count = np.sum(is_ground & ~said), np.sum(~is_ground & said), len(is_ground)
    if count == 0:
        return [np.nan] * 4
    ground, other = is_ground.sum(), (~is_ground).sum()
    agree = 1 - (lost + taken) / count
    chance = is_ground.mean() * said.mean() + (1 - is_ground.mean()) * (1 - said.mean())
    return [100 * lost / ground if ground else np.nan, 100 * taken / other if other else np.nan, 100 * (1 - agree),
            100 * (agree - chance) / (1 - chance) if chance < 1 else np.nan]


def cells(values, digits=2):
    return ["-" if not np.isfinite(v) else f"{v:.{digits}f}" for v in values]


def nearest(grid, transform, x, y):
    """Values of the cells that hold x, y; NaN outside."""
    i, j = np.floor((y - transform.f) / transform.e).astype(int), np.floor((x - transform.c) / transform.a).astype(int)
    inside = (i >= 0) & (j >= 0) & (i < grid.shape[0]) & (j < grid.shape[1])
    return np.where(inside, grid[np.where(inside, i, 0), np.where(inside, j, 0)], np.nan)


def raster(file, band=1):
    """Band of a raster as float, no data as NaN, and its transform."""
    with rasterio.open(file) as source:
        values = source.read(band).astype(float)
        if source.nodata is not None:
            values[values == source.nodata] = np.nan
        return values, source.transform


def stage_of(report, name):
    return next(stage for stage in report["stages"] if stage["type"] == name)


def points_of(output):
    """All tiles of a run: x, y, z and every other column."""
    columns = {}
    for file in sorted((output / "points").glob("*.la[sz]")):
        las = laspy.read(file)
        names = {"x": las.x, "y": las.y, "z": las.z, **{n: las[n] for n in las.point_format.dimension_names if n not in "XYZ"}}
        for name, column in names.items():
            columns.setdefault(name, []).append(np.asarray(column))
    return {name: np.concatenate(parts) for name, parts in columns.items()}


def paired(points, time, number):
    """Order of `points` in which they stand beside records of adjusted GPS time `time` and return number `number`; an error of latency shifts them all."""
    if len(points["x"]) != len(time):
        sys.exit(f"{len(points['x'])} points, {len(time)} records")
    mine = np.lexsort((points["return_number"], points["gps_time"]))
    theirs = np.lexsort((number, time))
    order = np.empty(len(mine), dtype=np.int64)
    order[theirs] = mine
    apart = points["gps_time"][order] - time
    if np.abs(apart - np.median(apart)).max() > 2e-6 or (points["return_number"][order] != number).any():
        sys.exit("points and records do not pair by time and return number")
    return order


def adjusted(week_seconds, week=2317):
    return np.asarray(week_seconds) + week * 604800.0 - 1e9


def errors_of(points, order, truth, names=("e", "n", "h")):
    return np.stack([points[a][order] - truth[n] for a, n in zip("xyz", names)], axis=1)


def rms(values, axis=0):
    return np.sqrt(np.mean(np.square(values), axis=axis))


def write_las(file, x, y, z, classes, scale=1e-4, time=None):
    """A LAS 1.4 file of points in map coordinates."""
    header = laspy.LasHeader(version="1.4", point_format=6)
    header.scales, header.offsets = [scale] * 3, np.floor([np.min(x), np.min(y), np.min(z)])
    header.global_encoding.wkt = True
    header.global_encoding.gps_time_type = laspy.header.GpsTimeType.STANDARD
    las = laspy.LasData(header)
    las.x, las.y, las.z, las.classification = x, y, z, classes
    las.return_number = las.number_of_returns = np.ones(len(x), np.uint8)
    las.gps_time = np.zeros(len(x)) if time is None else time
    las.write(file)


def lines_of(geopackage):
    """Contours of a GeoPackage: (elevation, vertices) per line."""
    with sqlite3.connect(geopackage) as base:
        table, column = base.execute("select table_name, column_name from gpkg_geometry_columns order by table_name != 'contours'").fetchone()
        names = [row[1] for row in base.execute(f'pragma table_info("{table}")')]
        level = next(n for n in names if re.match("elev|height|level", n, re.I))
        for height, blob in base.execute(f'select "{level}", "{column}" from "{table}"'):
            start = 8 + {0: 0, 1: 32, 2: 48, 3: 48, 4: 64}[blob[3] >> 1 & 7]
            kind, count = struct.unpack_from("<II", blob, start + 1)
            width = 3 if kind in (1002, 0x80000002) else 2
            yield height, np.frombuffer(blob, "<f8", count * width, start + 9).reshape(count, width)


def bilinear(grid, transform, x, y):
    """Heights of a grid (rasterio transform, heights at cell centres) at x, y; NaN outside."""
    column, row = (x - transform.c) / transform.a - 0.5, (y - transform.f) / transform.e - 0.5
    i, j = np.floor(row).astype(int), np.floor(column).astype(int)
    inside = (i >= 0) & (j >= 0) & (i < grid.shape[0] - 1) & (j < grid.shape[1] - 1)
    i, j = np.where(inside, i, 0), np.where(inside, j, 0)
    u, v = row - i, column - j
    z = (1 - u) * ((1 - v) * grid[i, j] + v * grid[i, j + 1]) + u * ((1 - v) * grid[i + 1, j] + v * grid[i + 1, j + 1])
    return np.where(inside, z, np.nan)


def table(head, rows):
    print("| " + " | ".join(head) + " |")
    print("|" + "---|" * len(head))
    for row in rows:
        print("| " + " | ".join(str(cell) for cell in row) + " |")
    print(flush=True)
