# SPDX-License-Identifier: GPL-3.0-or-later
"""What filters.water takes for water where there is none (simulated scenes, ISPRS samples), and on a real river (Autzen), by intensity."""
import laspy
import numpy as np

import common

CHAIN = [{"type": "filters.ground"}, {"type": "filters.water"}, {"type": "writers.las", "compress": False}]
RAW = [{"type": "readers.trajectory"}, {"type": "readers.laser"}, {"type": "georeference"}, {"type": "filters.returns"}]
SAMPLES = [11, 21, 24, 41, 52, 54, 71]

rows = []
folder = common.scratch("water")
for scene in ("flat", "town", "forest", "mixed"):
    survey = common.simulate(folder / scene, seed=41, world__scene=scene, world__water="false", imu__file="false", gnss__file="false")
    common.run([*RAW, *CHAIN], survey / "survey.toml", folder / f"{scene}_out")
    kind = common.points_of(folder / f"{scene}_out")["classification"]
    rows.append([f"simulated, {scene}, without water", len(kind), np.sum(kind == 9)])
for sample in SAMPLES:
    source = laspy.read(common.reference("isprs") / f"samp{sample}-utm.las")
    common.write_las(folder / "points.las", source.x, source.y, source.z, np.zeros(len(source.x), np.uint8), 0.01)
    (folder / "survey.toml").write_text('name = "sample"\ncrs = "EPSG:32632"\n[[points]]\nfile = "points.las"\ncrs = "EPSG:32632"\nline = 1\n')
    common.run([{"type": "readers.las"}, *CHAIN], folder / "survey.toml", folder / f"{sample}_out")
    kind = common.points_of(folder / f"{sample}_out")["classification"]
    rows.append([f"ISPRS {sample}", len(kind), np.sum(kind == 9)])
common.table(["cloud", "returns", "said water"], rows)

(folder / "survey.toml").write_text(f'name = "autzen"\n[[points]]\nfile = "{common.reference("autzen") / "autzen_trim.las"}"\nline = 1\n')
common.run([{"type": "readers.las"}, *CHAIN], folder / "survey.toml", folder / "autzen_out")
points = common.points_of(folder / "autzen_out")
water, ground = points["classification"] == 9, points["classification"] == 2
print(f"Autzen: {water.sum()} of {len(water)} returns are water; median intensity {np.median(points['intensity'][water]):.0f}, of ground {np.median(points['intensity'][ground]):.0f}; "
      f"heights of water {np.quantile(points['z'][water], 0.01):.1f} to {np.quantile(points['z'][water], 0.99):.1f}, of ground {np.quantile(points['z'][ground], 0.01):.1f} to {np.quantile(points['z'][ground], 0.99):.1f} ft")
