# SPDX-License-Identifier: GPL-3.0-or-later
"""Ground points of a USGS 3DEP project through terrain.dtm, against surveyed check points on open (NVA) and vegetated (VVA) ground.

Beside each: the mean of the ground points within 1 m of the check point, which is what the data themselves agree to.
"""
import json

import numpy as np
from scipy.spatial import cKDTree

import common

NAMES = {"NVA": "open (NVA)", "VVA": "vegetated (VVA)"}
NEAR = 1.0  # m

data = common.reference("coconino")
described = json.loads((data / "coconino__matched.json").read_text())
points = np.fromfile(data / "coconino__ground.f32", "<f4").reshape(-1, 3).astype(float)
assert len(points) == described["groundPoints"]
origin = np.array([described["originAlbersE"], described["originAlbersN"], 0.0])
crs = f"EPSG:{described['horizontalCrs']['epsg']}"
folder = common.scratch("coconino")
common.write_las(folder / "ground.las", *(points + origin).T, np.full(len(points), 2, np.uint8), 0.001)
(folder / "survey.toml").write_text(f'name = "Coconino"\ncrs = "{crs}"\n[[points]]\nfile = "ground.las"\ncrs = "{crs}"\nline = 1\n')
checks = described["checkpoints"]
kind = np.array([c["type"] for c in checks])
place = np.array([[c["e"], c["n"], c["z"]] for c in checks])
near = cKDTree(points[:, :2]).query_ball_point(place[:, :2], NEAR)
own = np.array([points[i, 2].mean() if i else np.nan for i in near]) - place[:, 2]

rows = []
for cell in ("0.5 m", "1 m", "2 m"):
    output = folder / cell
    common.run([{"type": "readers.las"}, {"type": "terrain.dtm", "cell": cell}, {"type": "writers.gdal"}], folder / "survey.toml", output, run__tile="2000 m")
    height, at = common.raster(output / "dtm.vrt")
    sigma, _ = common.raster(output / "dtm_quality.vrt")
    x, y = (place[:, :2] + origin[:2]).T
    error, stated = common.bilinear(height, at, x, y) - place[:, 2], common.nearest(sigma, at, x, y)
    for key, name in NAMES.items():
        here = (kind == key) & np.isfinite(error)
        e, ratio = error[here], error[here] / stated[here]
        rows.append([name, cell, f"{here.sum()} of {np.sum(kind == key)}", f"{e.mean():+.3f}", f"{common.rms(e):.3f}", f"{np.nanmean(own[kind == key]):+.3f}",
                     f"{common.rms(own[(kind == key) & np.isfinite(own)]):.3f}", f"{np.quantile(np.abs(e), 0.95):.3f}", f"{common.rms(ratio[np.isfinite(ratio)]):.2f}"])
common.table(["check points", "cell", "judged", "mean m", "rms m", "points within 1 m: mean m", "rms m", "95 % m", "error/sigma"], rows)
