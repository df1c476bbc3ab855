# SPDX-License-Identifier: GPL-3.0-or-later
"""autzen_trim.laz, a cloud in feet, through configs/cloud.toml: units of every product, and its own labels beside ours."""
import json

import laspy
import numpy as np
import rasterio

import common

FOOT = 0.3048

file = common.reference("autzen") / "autzen_trim.laz"
folder = common.scratch("feet")
(folder / "survey.toml").write_text(f'name = "Autzen"\ncrs = "EPSG:2994"\n[[points]]\nfile = "{file}"\ncrs = "EPSG:2994"\nweek = 1600\n')
report = common.run(common.ROOT / "configs/cloud.toml", folder / "survey.toml", folder / "out", dtm__cell="3 ft", contours__interval="2 ft",
                    contours__tolerance="0.1 ft")
source, points = laspy.read(file), common.points_of(folder / "out")
key = lambda p, time: np.lexsort((np.asarray(p["return_number"]), time))
mine, theirs = key(points, points["gps_time"]), key(source, np.asarray(source.gps_time))
apart = [np.abs(points[a][mine] - np.asarray(source[a])[theirs]).max() for a in "xyz"]
said, had = points["classification"][mine] == 2, np.asarray(source.classification)[theirs] == 2
tile = next((folder / "out/points").glob("*.laz"))
with laspy.open(tile) as opened:
    crs = next(v for v in opened.header.vlrs if v.record_id == 2112).string
with rasterio.open(folder / "out/dtm.vrt") as dtm:
    heights = dtm.read(1, masked=True)
    with rasterio.open(next((folder / "out/dtm").glob("*.tif"))) as one:
        grid = f"{dtm.res[0]:g} x {dtm.res[1]:g} {one.crs.linear_units}, band unit {one.units[0]}"
    place, raster = dtm.transform, heights.filled(np.nan).astype(float)
levels, on_dtm = [], []
for level, line in common.lines_of(folder / "out/contours.gpkg"):
    levels.append(level)
    on_dtm.append(common.bilinear(raster, place, line[:, 0], line[:, 1]) - level)
on_dtm = np.concatenate(on_dtm)
common.table(["what", "found"], [
    ["points in, out", f"{len(source.x)}, {len(points['x'])}"],
    ["largest difference of x, y, z from the file (ft)", " ".join(f"{v:.4f}" for v in apart)],
    ["CRS of the tiles", crs[:60].replace("|", " ")],
    ["unit there", ", ".join(sorted(set(part.split("]")[0] for part in crs.replace('"', "").split("UNIT[")[1:])))],
    ["terrain model", grid],
    ["heights of the file, of the terrain model (ft)", f"{np.min(source.z):.2f} to {np.max(source.z):.2f}, {heights.min():.2f} to {heights.max():.2f}"],
    ["contours", f"{len(levels)} lines, {min(levels):g} to {max(levels):g} ft, steps of {np.diff(np.unique(levels)).min():g} ft"],
    ["contour vertices above the terrain model (ft): rms, largest", f"{np.sqrt(np.nanmean(on_dtm ** 2)):.3f}, {np.nanmax(np.abs(on_dtm)):.3f}"],
    ["ground here, in the file, both", f"{said.sum()}, {had.sum()}, {(said & had).sum()}"],
])
print(json.dumps({k: v for k, v in report["crs"].items() if k != "definition"}))
