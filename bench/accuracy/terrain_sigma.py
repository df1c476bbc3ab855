# SPDX-License-Identifier: GPL-3.0-or-later
"""Error over sigma of terrain model cells by cover, over simulated surveys whose errors are drawn anew: terrain_sigma.py [SURVEYS]"""
import sys

import numpy as np
import rasterio

import common

SCENES = {"open": {"world.scene": "hills", "world.trees": 0, "world.low_vegetation": 0}, "forest": {"world.scene": "forest"}, "steep": {"world.scene": "steep"},
          "town": {"world.scene": "town"}}
COMMON = {"world.length": "250 m", "world.width": "200 m", "flight.lines": 2, "flight.cross_lines": 0, "imu.file": "false", "gnss.file": "false",
          "output.dtm_cell": "1 m", "mounting.deliver": "drawn"}
GEOREFERENCE = [{"type": "readers.trajectory"}, {"type": "readers.laser"}, {"type": "georeference"}]
# Ground as it is known, so that what is judged is the terrain model; and as the filter finds it.
CHAINS = {"filtered": [{"type": "filters.returns"}, {"type": "filters.noise"}, {"type": "filters.smrf"}]}


def band(file, number=1):
    with rasterio.open(file) as raster:
        values = raster.read(number).astype(float)
        values[values == raster.nodata] = np.nan
        return values, raster.transform


def ratios(output, survey):
    """Squares of error over sigma: all cells, and those that no ground point but a building's roof covers."""
    height, place = band(output / "dtm.vrt")
    with rasterio.open(output / "dtm_quality.vrt") as raster:
        sigma = raster.read(raster.descriptions.index("sigma") + 1).astype(float)
        sigma[sigma == raster.nodata] = np.nan
    truth, at = band(survey / "truth/dtm.tif")
    i, j = np.nonzero(np.isfinite(height) & (sigma > 0))
    x, y = place.c + (j + 0.5) * place.a, place.f + (i + 0.5) * place.e
    square = np.square((height[i, j] - common.bilinear(truth, at, x, y)) / sigma[i, j])
    returns = np.load(survey / "truth/returns.npy")
    roof = np.zeros(height.shape, bool)
    of_roof = returns["cls"] == 6
    row, column = ((returns["n"][of_roof] - place.f) // place.e).astype(int), ((returns["e"][of_roof] - place.c) // place.a).astype(int)
    inside = (row >= 0) & (column >= 0) & (row < height.shape[0]) & (column < height.shape[1])
    roof[row[inside], column[inside]] = True
    known = np.isfinite(square)
    return square[known & ~roof[i, j]], square[known & roof[i, j]]


if __name__ == "__main__":
    surveys = int(sys.argv[1]) if len(sys.argv) > 1 else 10
    rows = []
    for number, (scene, options) in enumerate(SCENES.items()):
        for chain, filters in CHAINS.items():
            free, covered = [], []
            for k in range(surveys):
                folder = common.scratch("terrain_sigma")
                survey = common.simulate(folder / "survey", **{**COMMON, **options, "seed": 100 * number + k})
                common.run(GEOREFERENCE + filters + [{"type": "terrain.dtm"}, {"type": "writers.gdal"}], survey / "survey.toml", folder / "out")
                a, b = ratios(folder / "out", survey)
                free.append(a.mean())
                if len(b) > 100:
                    covered.append(b.mean())
            for name, values in ((scene, free), (f"{scene}, under buildings", covered)):
                if values:
                    rows.append([name, chain, len(values), f"{np.sqrt(np.mean(values)):.2f}", f"{np.sqrt(np.min(values)):.2f} to {np.sqrt(np.max(values)):.2f}"])
    common.table(["cover", "ground", "surveys", "error over sigma", "single surveys"], rows)
