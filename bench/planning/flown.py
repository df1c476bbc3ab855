#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A plan over hilly ground, flown by `swath simulate` and georeferenced: is what was flown what was planned?

  SWATH_PROGRAM=build/release/tools/swath python3 bench/planning/flown.py [--seeds 20] [--turbulence 1]

Each seed is another terrain, another drawn calibration and another trajectory error. Of every cell that all beams of its lines meet whole: pulses per m2
and lines that see it, measured / planned. Of every point: its height less the true ground's at its place, against the plan's sigma of its cell.
Wants numpy, rasterio and laspy."""
import argparse
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

import laspy
import numpy
import rasterio
from rasterio.transform import from_origin

PROGRAM = os.environ.get("SWATH_PROGRAM", "build/release/tools/swath")
ROOT = pathlib.Path(__file__).resolve().parents[2]
PLAN = """
area = "area.geojson"
dem = "dem.tif"
cell = "{cell} m"
[sensor]
pattern = "{pattern}"
prf = "{prf} Hz"
frequency = "{frequency} Hz"
half_angle = "{half_angle} deg"
[flight]
height = "{height} m"
speed = "{speed} m/s"
overlap = 0.25
terrain_following = {following}
cross_lines = 1
margin = "60 m"
[sigma]
roll = "0.004 deg"
pitch = "0.004 deg"
heading = "0.008 deg"
lever_arm = "1 cm"
range = "2 cm"
range_offset = "1 cm"
scan_angle = "0.002 deg"
beam_divergence = "0.3 mrad"
[simulate.flight]
turbulence = {turbulence}
[simulate.noise]
high_points = 0.0
low_points = 0.0
multipath = 0.0
[simulate.mounting]
deliver = "drawn"
[simulate.imu]
file = false
[simulate.gnss]
file = false
"""


def terrain(file, random):
    """4 km by 4 km of waves, their corner off every lattice."""
    side, cell, west, north = 400, 10.0, 611003.7, 5309211.3
    x, y = numpy.meshgrid(west + cell * (numpy.arange(side) + 0.5), north - cell * (numpy.arange(side) + 0.5))
    z = numpy.full_like(x, 600.0)
    for _ in range(8):
        length, angle, phase = random.uniform(500, 2000), random.uniform(0, 2 * numpy.pi), random.uniform(0, 2 * numpy.pi)
        z += 0.02 * length * random.uniform(0.5, 1.2) * numpy.sin(2 * numpy.pi / length * (x * numpy.cos(angle) + y * numpy.sin(angle)) + phase)
    with rasterio.open(file, "w", driver="GTiff", height=side, width=side, count=1, dtype="float32", crs="EPSG:32632", transform=from_origin(west, north, cell, cell)) as d:
        d.write(z.astype("float32"), 1)
    return z.astype("float32").astype(float), west + cell / 2, north - cell / 2, cell


def bilinear(ground, x, y):
    z, x0, y0, cell = ground
    u, v = (x - x0) / cell, (y0 - y) / cell
    i, j = numpy.clip(u.astype(int), 0, z.shape[1] - 2), numpy.clip(v.astype(int), 0, z.shape[0] - 2)
    fu, fv = u - i, v - j
    return (1 - fv) * ((1 - fu) * z[j, i] + fu * z[j, i + 1]) + fv * ((1 - fu) * z[j + 1, i] + fu * z[j + 1, i + 1])


def area(file, random):
    """A leaning quadrangle."""
    middle, turn = numpy.array([612950.0, 5307250.0]), random.uniform(0, numpy.pi)
    corners = [(-700, -450), (650, -520), (720, 430), (-610, 500)]
    places = [middle + numpy.array([numpy.cos(turn) * a - numpy.sin(turn) * b, numpy.sin(turn) * a + numpy.cos(turn) * b]) for a, b in corners]
    ring = ",".join(f"[{p[0]:.2f},{p[1]:.2f}]" for p in places + places[:1])
    file.write_text('{"type":"FeatureCollection","crs":{"type":"name","properties":{"name":"urn:ogc:def:crs:EPSG::32632"}},"features":[{"type":"Feature","properties":{},"geometry":'
                    f'{{"type":"Polygon","coordinates":[[{ring}]]}}}}]}}')


def swath(*words):
    done = subprocess.run([PROGRAM, *map(str, words)], capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"{' '.join(map(str, words))}\n{done.stderr}")
    return done.stdout


def band(file, number=1):
    with rasterio.open(file) as d:
        values = d.read(number).astype(float)
        values[values == d.nodata] = numpy.nan
        return values, d.transform


def one(seed, folder, turbulence):
    random = numpy.random.default_rng(seed)
    ground = terrain(folder / "dem.tif", random)
    area(folder / "area.geojson", random)
    half_angle = random.uniform(14, 28)
    height = random.uniform(450, 800)
    speed = random.uniform(45, 70)
    prf = 1.5 * speed * 2 * height * numpy.tan(numpy.radians(half_angle))  # 1.5 pulses per m2 of one swath
    pattern = ["triangle", "sine", "polygon"][seed % 3]
    text = PLAN.format(cell=40, pattern=pattern, prf=round(prf), frequency=round(random.uniform(30, 60)), half_angle=half_angle,
                       height=height, speed=speed, following=str(bool(seed % 2)).lower(), turbulence=turbulence)
    (folder / "plan.toml").write_text(text)
    swath("plan", folder / "plan.toml", "--output", folder / "plan", "--quiet")
    swath("simulate", folder / "flown", "--config", folder / "plan/simulate.json", "--set", f"seed={seed}", "--quiet")
    swath("run", ROOT / "configs/georeference.toml", "--survey", folder / "flown/survey.toml", "--output", folder / "out", "--quiet")
    density, grid = band(folder / "plan/density.tif")
    seen, _ = band(folder / "plan/lines_seen.tif")
    sigma, _ = band(folder / "plan/sigma.tif")
    cell, (rows, columns) = grid.a, density.shape
    count, lines = numpy.zeros(density.shape), {}
    squares, expected, n = 0.0, 0.0, 0
    per_cell = numpy.zeros(density.shape)
    for file in sorted((folder / "out").rglob("*.las")):
        las = laspy.read(file)
        x, y, z = numpy.array(las.x), numpy.array(las.y), numpy.array(las.z)
        i, j = numpy.floor((x - grid.c) / cell).astype(int), numpy.floor((grid.f - y) / cell).astype(int)
        inside = (i >= 0) & (j >= 0) & (i < columns) & (j < rows)
        x, y, z, i, j = x[inside], y[inside], z[inside], i[inside], j[inside]
        numpy.add.at(count, (j, i), 1)
        source = numpy.array(las.point_source_id)[inside]
        for line in numpy.unique(source):
            there = lines.setdefault(int(line), numpy.zeros(density.shape))
            numpy.add.at(there, (j[source == line], i[source == line]), 1)
        error = z - bilinear(ground, x, y)
        known = numpy.isfinite(sigma[j, i])
        squares += float((error[known] ** 2).sum())
        expected += float((sigma[j, i][known] ** 2).sum())
        n += int(known.sum())
        numpy.add.at(per_cell, (j[known], i[known]), error[known] ** 2)
    whole = numpy.isfinite(density) & (numpy.abs(seen - numpy.round(seen)) < 1e-3)
    ratio = count[whole] / cell**2 / density[whole]
    overlap = sum((there > 0.02 * count).astype(int) for there in lines.values())
    return {"density": ratio, "overlap": (overlap[whole] == numpy.round(seen[whole])), "rms": numpy.sqrt(squares / n), "sigma": numpy.sqrt(expected / n), "all": count[numpy.isfinite(density)].sum() / cell**2 / density[numpy.isfinite(density)].sum(),
            "cells": numpy.sqrt(per_cell[whole] / numpy.maximum(count[whole], 1)) / sigma[whole]}


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--first", type=int, default=1)
    parser.add_argument("--turbulence", type=float, default=1.0)
    a = parser.parse_args()
    scratch = pathlib.Path(os.environ.get("SWATH_SCRATCH", tempfile.gettempdir())) / "swath_flown"
    print("| seed | cells | density flown / planned: mean, sd | within 10 % | lines as planned | rms of errors m | sigma m | error / sigma |\n|---|---|---|---|---|---|---|---|")
    densities, overlaps, squares, expected = [], [], 0.0, 0.0
    for seed in range(a.first, a.first + a.seeds):
        shutil.rmtree(scratch, ignore_errors=True)
        scratch.mkdir(parents=True)
        r = one(seed, scratch, a.turbulence)
        d = r["density"]
        densities.append(d)
        overlaps.append(r["overlap"])
        squares += r["rms"] ** 2
        expected += r["sigma"] ** 2
        print(f"| {seed} | {d.size} | {d.mean():.3f}, {d.std():.3f} | {100 * (abs(d - 1) < 0.1).mean():.1f} % | {100 * r['overlap'].mean():.1f} % | {r['rms']:.3f} | {r['sigma']:.3f} | {r['rms'] / r['sigma']:.2f} |", flush=True)
    d, o = numpy.concatenate(densities), numpy.concatenate(overlaps)
    print(f"\nall {d.size} cells: {100 * (abs(d - 1) < 0.1).mean():.2f} % within 10 %, mean {d.mean():.4f}; lines as planned in {100 * o.mean():.2f} %; error / sigma {numpy.sqrt(squares / expected):.3f}")
    shutil.rmtree(scratch, ignore_errors=True)


if __name__ == "__main__":
    main()
