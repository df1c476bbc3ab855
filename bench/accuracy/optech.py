# SPDX-License-Identifier: GPL-3.0-or-later
"""Optech sample.csd through the program: every pulse, and its first point beside the local linearisation's figure."""
import numpy as np
from rasterio.warp import transform

import common

SURVEY = """name = "csd"
crs = "EPSG:32617"
calibration_file = "{file}"

[scanner]
model = "mirror"

[[laser]]
file = "{file}"
line = 1

[[trajectory]]
file = "{file}"
spacing = "0 s"
"""
FIRST = (-82.554028877408555, 36.534611447321907, 344.80889224602356)  # PDAL's test of its Optech reader

file = common.reference("optech_csd") / "sample.csd"
folder = common.scratch("optech")
(folder / "survey.toml").write_text(SURVEY.format(file=file))
report = common.run(common.ROOT / "configs/georeference.toml", folder / "survey.toml", folder / "out", las__scale="0.0001")
points = common.points_of(folder / "out")
first = np.argmin(points["gps_time"])
(east,), (north,) = transform("EPSG:4326", "EPSG:32617", [FIRST[0]], [FIRST[1]])
common.table(["pulses in the file", "points", "lines", "E", "N", "height"],
             [[(file.stat().st_size - 2048) // 69, len(points["x"]), len(np.unique(points["point_source_id"])),
               *(f"{points[a].min():.2f} to {points[a].max():.2f}" for a in "xyz")]])
common.table(["first point", "E", "N", "height"],
             [["this program, rigorous", *(f"{points[a][first]:.4f}" for a in "xyz")],
              ["local linearisation", f"{east:.4f}", f"{north:.4f}", f"{FIRST[2]:.4f}"],
              ["difference mm", *(f"{1e3 * d:.1f}" for d in (points["x"][first] - east, points["y"][first] - north, points["z"][first] - FIRST[2]))]])
