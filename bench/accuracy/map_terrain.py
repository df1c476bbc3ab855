# SPDX-License-Identifier: GPL-3.0-or-later
"""Terrain models of contours and spot heights alone, against the surface that these were traced on.

    map_terrain.py [--scenes hills steep] [--seeds 1 2] [--intervals 1 2 5 10] [--cell 2] [--set world.KEY=VALUE ...]

The true terrain of a simulated survey becomes a cloud, terrain.contours traces it with its defaults, and swath map-dtm makes a model of these lines and
spot heights, with flat parts filled and kept. The contours have an error of a twentieth of the interval of their own.
"""
import argparse

import numpy as np
import rasterio

import common

PARTS = {1: "between contours", 2: "flat, filled", 3: "flat, kept"}


def judged(folder, grid, at):
    height, place = common.raster(folder / "dtm.tif")
    part, _ = common.raster(folder / "dtm_part.tif")
    with rasterio.open(folder / "dtm_quality.tif") as source:
        sigma = source.read(list(source.descriptions).index("sigma") + 1).astype(float)
    i, j = np.nonzero(np.isfinite(height))
    x, y = place.c + (j + 0.5) * place.a, place.f + (i + 0.5) * place.e
    e = height[i, j] - common.bilinear(grid, at, x, y)
    known = np.isfinite(e)
    return e[known], part[i, j][known], sigma[i, j][known]


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--scenes", nargs="+", default=["hills", "steep"])
    p.add_argument("--seeds", type=int, nargs="+", default=[1, 2])
    p.add_argument("--intervals", type=float, nargs="+", default=[1, 2, 5, 10])
    p.add_argument("--cell", type=float, default=2.0)
    p.add_argument("--set", action="append", default=[])
    given = p.parse_args()
    options = {"imu.file": "false", "gnss.file": "false", "world.length": "1000 m", "world.width": "800 m", "world.trees": 0, "output.dtm_cell": "1 m",
               "scanner.prf": "3 kHz", "flight.lines": 1, "flight.cross_lines": 0, **dict(o.split("=", 1) for o in given.set)}
    rows = []
    for scene in given.scenes:
        found = {}
        for seed in given.seeds:
            folder = common.scratch("map_terrain")
            survey = common.simulate(folder / "survey", seed=seed, world__scene=scene, **options)
            grid, at = common.raster(survey / "truth/dtm.tif")
            i, j = np.nonzero(np.isfinite(grid))
            x, y = at.c + (j + 0.5) * at.a, at.f + (i + 0.5) * at.e
            common.write_las(folder / "truth.las", x, y, grid[i, j], np.full(len(x), 2, np.uint8))
            (folder / "survey.toml").write_text('name = "truth"\ncrs = "EPSG:32632"\n[[points]]\nfile = "truth.las"\ncrs = "EPSG:32632"\n')
            chain = [{"type": "readers.las"}, {"type": "terrain.dtm", "cell": "1 m", "smoothing": "0 m", "assumed_sigma": "1 cm"}, {"type": "terrain.contours"},
                     {"type": "writers.gdal"}]
            for interval in given.intervals:
                out = folder / f"out{interval:g}"
                common.run(chain, folder / "survey.toml", out, contours__interval=f"{interval} m")
                for flats in ("fill", "keep"):
                    model = folder / f"map{interval:g}{flats}"
                    common.call("map-dtm", out / "contours.gpkg", "--cell", f"{given.cell} m", "--flats", flats, "--output", model, "--quiet")
                    for column, values in zip(("e", "part", "sigma"), judged(model, grid, at)):
                        found.setdefault((interval, flats, column), []).append(values)
        for interval in given.intervals:
            for flats in ("fill", "keep"):
                e, part, sigma = (np.concatenate(found[interval, flats, c]) for c in ("e", "part", "sigma"))
                cells = [scene, f"{interval:g} m", flats, len(e), f"{e.mean():+.3f}", f"{common.rms(e):.3f}", f"{np.quantile(np.abs(e), 0.95):.3f}",
                         f"{100 * common.rms(e) / interval:.1f}", f"{common.rms(e) / common.rms(sigma):.2f}"]
                for kind in (1, 2 if flats == "fill" else 3):
                    here = part == kind
                    cells.append(f"{common.rms(e[here]):.3f} ({100 * here.mean():.0f} %), {common.rms(e[here]) / common.rms(sigma[here]):.2f}" if here.any() else "-")
                rows.append(cells)
    common.table(["scene", "interval", "flat parts", "cells", "mean m", "rms m", "95 % m", "rms, % of the interval", "error / sigma", "between contours: rms (share), error / sigma",
                  "flat parts: the same"], rows)


if __name__ == "__main__":
    main()
