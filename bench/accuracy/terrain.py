# SPDX-License-Identifier: GPL-3.0-or-later
"""TIN, terrain model and contours on the true ground points of simulated surveys, against the analytic terrain."""
import sys

import numpy as np
import rasterio

import common

SCENES = {"open": {"world.scene": "hills", "world.trees": 0, "world.low_vegetation": 0}, "forest": {"world.scene": "forest"}, "steep": {"world.scene": "steep"},
          "mixed": {"world.scene": "mixed"}}
COMMON = {"world.length": "400 m", "world.width": "250 m", "flight.lines": 2, "flight.cross_lines": 0, "imu.file": "false", "gnss.file": "false",
          "output.dtm_cell": "0.25 m"}
GEOREFERENCE = [{"type": "readers.trajectory"}, {"type": "readers.laser"}, {"type": "georeference"},
                {"type": "writers.las", "compress": False, "scale": 0.0001}]
TERRAIN = [{"type": "readers.las"}, {"type": "terrain.dtm"}, {"type": "terrain.contours"}, {"type": "writers.gdal"}]
LEVEL, STEEP = 0.02, 0.35  # rise / run
REACH = 1  # cells: a ground point lies in the cell or in one of the eight around it, otherwise the cell is bridged


def millimetres(values):
    values = np.asarray(values)
    return ["-"] * 4 if values.size == 0 else [f"{1e3 * values.mean():+.1f}", f"{1e3 * np.median(np.abs(values)):.1f}", f"{1e3 * common.rms(values):.1f}",
                                               f"{1e3 * np.quantile(np.abs(values), 0.95):.1f}"]


def true_terrain(survey):
    with rasterio.open(survey / "truth/dtm.tif") as file:
        grid = file.read(1).astype(float)
        grid[grid == file.nodata] = np.nan
        return grid, file.transform


def cells(output, truth, at, x_ground, y_ground):
    """Errors of the terrain model's cells, the truth's slope there, and whether a ground point is near."""
    with rasterio.open(output / "dtm.vrt") as file:
        height = file.read(1).astype(float)
        height[height == file.nodata] = np.nan
        place = file.transform
    occupied = np.zeros(np.array(height.shape) + 2 * REACH, bool)
    occupied[((y_ground - place.f) // place.e).astype(int) + REACH, ((x_ground - place.c) // place.a).astype(int) + REACH] = True
    span = range(2 * REACH + 1)
    near = np.any([occupied[r:r + height.shape[0], c:c + height.shape[1]] for r in span for c in span], axis=0)
    i, j = np.nonzero(np.isfinite(height))
    x, y = place.c + (j + 0.5) * place.a, place.f + (i + 0.5) * place.e
    z = common.bilinear(truth, at, x, y)
    east, west, north, south = (common.bilinear(truth, at, x + dx, y + dy) for dx, dy in ((1, 0), (-1, 0), (0, 1), (0, -1)))
    slope = np.hypot(east - west, north - south) / 2
    known = np.isfinite(slope + z)
    return (height[i, j] - z)[known], slope[known], near[i, j][known]


def vertices(output, truth, at):
    """Height of the true terrain above the contour and its slope, at every vertex."""
    errors, slopes, lines = [], [], 0
    for level, line in common.lines_of(output / "contours.gpkg"):
        x, y = line[:, 0], line[:, 1]
        errors.append(common.bilinear(truth, at, x, y) - level)
        east, west, north, south = (common.bilinear(truth, at, x + dx, y + dy) for dx, dy in ((0.5, 0), (-0.5, 0), (0, 0.5), (0, -0.5)))
        slopes.append(np.hypot(east - west, north - south))
        lines += 1
    errors, slopes = np.concatenate(errors), np.concatenate(slopes)
    known = np.isfinite(errors + slopes)
    return errors[known], slopes[known], lines


folder = common.scratch("terrain")
models, contours = [], []
for scene, options in SCENES.items():
    survey = common.simulate(folder / scene, **{**COMMON, **options})
    truth = np.load(survey / "truth/returns.npy")
    grid, at = true_terrain(survey)
    common.run(GEOREFERENCE, survey / "survey.toml", folder / "points")
    points = common.points_of(folder / "points")
    order = common.paired(points, truth["t"] - 1e9, truth["rn"])
    ground = truth["cls"] == 2
    on_ground = truth["h"][ground] - common.bilinear(grid, at, truth["e"][ground], truth["n"][ground])
    print(f"{scene}: {ground.sum()} ground points; the true ones lie on the grid of the analytic terrain within",
          f"{1e3 * np.nanmedian(np.abs(on_ground)):.2f} mm (median)", file=sys.stderr)
    clouds = {"true places": [truth[a][ground] for a in "enh"], "as georeferenced": [points[a][order][ground] for a in "xyz"]}
    for name, xyz in clouds.items():
        common.write_las(folder / "ground.las", *xyz, np.full(ground.sum(), 2, np.uint8))
        (folder / "survey.toml").write_text('name = "ground"\ncrs = "EPSG:32632"\n[[points]]\nfile = "ground.las"\ncrs = "EPSG:32632"\nline = 1\n')
        for tolerance in ("0 m", "0.1 m"):
            output = common.scratch("terrain/out")
            common.run(TERRAIN, folder / "survey.toml", output / "run", contours__tolerance=tolerance)
            if tolerance == "0 m":
                error, slope, near = cells(output / "run", grid, at, *xyz[:2])
                parts = {"all": slope >= 0, "points near": near, f"points near, slope > {STEEP}": near & (slope > STEEP), "bridged": ~near}
                models += [[scene, name, part, where.sum(), *millimetres(error[where])] for part, where in parts.items() if where.any()]
            error, slope, lines = vertices(output / "run", grid, at)
            aside = np.abs(error[slope > LEVEL]) / slope[slope > LEVEL]
            contours.append([scene, name, tolerance, lines, len(error), *millimetres(error), f"{np.median(aside):.3f}", f"{np.quantile(aside, 0.95):.3f}"])
common.table(["scene", "points", "part", "cells", "mean mm", "median abs mm", "rms mm", "95 % mm"], models)
common.table(["scene", "points", "tolerance", "lines", "vertices", "mean mm", "median abs mm", "rms mm", "95 % mm", "aside median m", "95 % m"], contours)
