# SPDX-License-Identifier: GPL-3.0-or-later
"""Ground points of a USGS 3DEP project through terrain.dtm, against surveyed check points on open (NVA) and vegetated (VVA) ground.

The points lie in patches of 6 m about check points that are spread over 114 km: each patch is moved by whole metres to a place of its own, so that one
small raster holds them all. Beside each figure: the mean of the ground points within 1 m of the check point, which is what the data themselves agree to.
"""
import json

import numpy as np
from scipy.spatial import cKDTree

import common

NAMES = {"NVA": "open (NVA)", "VVA": "vegetated (VVA)"}
NEAR, PATCH, APART = 1.0, 4.5, 200.0  # m

data = common.reference("coconino")
described = json.loads((data / "coconino__matched.json").read_text())
points = np.fromfile(data / "coconino__ground.f32", "<f4").reshape(-1, 3).astype(float)
assert len(points) == described["groundPoints"]
origin = np.array([described["originAlbersE"], described["originAlbersN"], 0.0])
crs = f"EPSG:{described['horizontalCrs']['epsg']}"
checks = described["checkpoints"]
kind = np.array([c["type"] for c in checks])
place = np.array([[c["e"], c["n"], c["z"]] for c in checks])
tree = cKDTree(points[:, :2])
own = np.array([points[i, 2].mean() if i else np.nan for i in tree.query_ball_point(place[:, :2], NEAR)]) - place[:, 2]
# Patch k goes to column k % 8, row k // 8 of a lattice, by whole metres.
k = np.arange(len(place))
move = np.c_[APART * (k % 8), APART * (k // 8)] - np.floor(place[:, :2]) + np.floor(origin[:2])
patches = tree.query_ball_point(place[:, :2], PATCH)
moved = np.concatenate([points[i] + [*move[n], 0.0] for n, i in enumerate(patches)])
x, y = (place[:, :2] + move).T

folder = common.scratch("coconino")
common.write_las(folder / "ground.las", *moved.T, np.full(len(moved), 2, np.uint8), 0.001)
(folder / "check.csv").write_text("name,x,y,z,cover\n" + "".join(f"{n},{x[n]:.3f},{y[n]:.3f},{place[n, 2]:.3f},{kind[n]}\n" for n in range(len(place))))
(folder / "survey.toml").write_text(f'name = "Coconino"\ncrs = "{crs}"\n[[points]]\nfile = "ground.las"\ncrs = "{crs}"\nline = 1\n'
                                    '[[control]]\nfile = "check.csv"\nuse = "check"\n')
rows = []
for cell in ("0.5 m", "1 m"):
    output = folder / cell
    common.run([{"type": "readers.las"}, {"type": "terrain.dtm", "cell": cell}, {"type": "quality.points", "open": ["NVA"], "surface": "mean"}, {"type": "writers.gdal"}], folder / "survey.toml", output)
    height, at = common.raster(output / "dtm.vrt")
    error = common.bilinear(height, at, x, y) - place[:, 2]
    for key, name in NAMES.items():
        here = (kind == key) & np.isfinite(error)
        e, near = error[here], own[(kind == key) & np.isfinite(own)]
        rows.append([name, cell, f"{here.sum()} of {np.sum(kind == key)}", f"{e.mean():+.3f}", f"{common.rms(e):.3f}", f"{np.quantile(np.abs(e), 0.95):.3f}",
                     f"{near.mean():+.3f}", f"{common.rms(near):.3f}"])
common.table(["check points", "cell", "judged", "mean m", "rms m", "95 % m", "points within 1 m: mean m", "rms m"], rows)

stage = next(s for s in json.loads((output / "report.json").read_text())["stages"] if s["type"] == "quality.points")
common.table(["quality.points", "product", "n", "mean m", "rms m", "95 % m", "rms with marks m"],
             [[a["cover"], a["product"], str(a["n"]), f"{a['mean']:+.3f}", f"{a['rms']:.3f}", f"{a['q95']:.3f}", f"{a['rmse_with_marks_m']:.3f}"]
              for a in stage["findings"]["accuracy"] if "(" in a["cover"]])
