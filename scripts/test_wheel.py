# SPDX-License-Identifier: GPL-3.0-or-later
"""What an installed wheel must be able to do, run by scripts/test_packages.sh: test_wheel.py PRODUCTS (of `swath demo`)."""
import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np

import swath

products = Path(sys.argv[1])
points = swath.read_points(str(products / "points/*.laz"))
print(f"  {points!r}"[:120])
ground = swath.ground(points)
dtm = swath.dtm(ground, cell="2 m")
share = np.mean(np.isfinite(dtm.height))
assert share > 0.5, share
dtm.write("dtm.tif")
np.testing.assert_array_equal(swath.read_grid("dtm.tif").height, dtm.height)
lines = swath.contours(ground, interval="2 m", dtm={"cell": "2 m"})
for name in ("lines.gpkg", "lines.geojson", "lines.dxf"):
    lines.write(name)
points.write("copy.laz")
copy = swath.read_points("copy.laz").array
for field in points.array.dtype.names:  # by field: NaN is unknown, and equal to itself
    np.testing.assert_array_equal(copy[field], points.array[field], field)

# A folder that PROJ_DATA names may hold grids alone: the database is the wheel's, for the module and for the program.
grids = Path("grids")
grids.mkdir(exist_ok=True)
header = np.array([-90.0, -180.0, 90.0, 90.0], ">f8").tobytes() + np.array([3, 5], ">i4").tobytes()  # a GTX of 90 degrees a cell
(grids / "own.gtx").write_bytes(header + np.full(15, 40.0, ">f4").tobytes())
swath.write_points({"x": np.array([5e5]), "y": np.array([5.3e6]), "z": np.array([100.0])}, "ellipsoidal.laz", "EPSG:32632")
Path("survey.json").write_text(json.dumps({
    "crs": "+proj=utm +zone=32 +datum=WGS84 +units=m +geoidgrids=own.gtx +vunits=m",
    "points": [{"file": "ellipsoidal.laz", "crs": "EPSG:32632+ellipsoidal"}]}))
Path("config.json").write_text(json.dumps({"stage": [{"type": "readers.las"}, {"type": "writers.las"}]}))
beside = Path(sys.executable).parent
for out, command in (("module", [sys.executable, "-c", "import swath; swath.Pipeline('config.json', 'survey.json', 'module').run()"]),
                     ("program", [beside / "swath", "run", "config.json", "--survey", "survey.json", "--output", "program"])):
    done = subprocess.run(command, env=os.environ | {"PROJ_DATA": str(grids.resolve())}, capture_output=True, text=True)
    assert done.returncode == 0, f"{out}: {done.stderr}"
    assert abs(swath.read_points(f"{out}/points/*.laz").z[0] - 60.0) < 1e-3, out
print("  the module reads, filters, models and writes; module and program find grids of PROJ_DATA")
