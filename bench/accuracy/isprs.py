# SPDX-License-Identifier: GPL-3.0-or-later
"""Seven samples of the ISPRS filter test: ground by SMRF with its defaults against the reference labels."""
import laspy
import numpy as np

import common

PDAL = {11: 9.9, 21: 2.5, 24: 4.1, 41: 6.5, 52: 4.5, 54: 7.0, 71: 3.7}
SMRF = {"type": "filters.smrf"}
CHAINS = {"SMRF": [SMRF], "noise + SMRF": [{"type": "filters.noise"}, SMRF]}

data = common.reference("isprs")
folder = common.scratch("isprs")
rows, totals = [], {name: [] for name in CHAINS}
for sample in PDAL:
    source = laspy.read(data / f"samp{sample}-utm.las")
    ground = np.asarray(source.classification) == 2
    count = len(ground)
    # Numbered by their time, so that every point is found again.
    common.write_las(folder / f"{sample}.las", source.x, source.y, source.z, np.zeros(count, np.uint8), 0.01, np.arange(count, dtype=float))
    (folder / "survey.toml").write_text(f'name = "samp{sample}"\ncrs = "EPSG:32632"\n[[points]]\nfile = "{sample}.las"\ncrs = "EPSG:32632"\nline = 1\n')
    for name, chain in CHAINS.items():
        output = folder / f"{sample} {name}"
        common.run([{"type": "readers.las"}, *chain, {"type": "writers.las", "compress": False}], folder / "survey.toml", output)
        points = common.points_of(output)
        said = np.zeros(count, bool)
        said[np.round(points["gps_time"]).astype(int)] = points["classification"] == 2
        assert len(points["x"]) == count
        lost, taken = np.sum(ground & ~said), np.sum(~ground & said)
        agree = 1 - (lost + taken) / count
        chance = (ground.mean() * said.mean()) + ((1 - ground.mean()) * (1 - said.mean()))
        totals[name].append([100 * lost / ground.sum(), 100 * taken / (~ground).sum(), 100 * (1 - agree), 100 * (agree - chance) / (1 - chance)])
for i, sample in enumerate(PDAL):
    plain, noise = totals["SMRF"][i], totals["noise + SMRF"][i]
    rows.append([sample, *(f"{v:.2f}" for v in plain), PDAL[sample], *(f"{v:.2f}" for v in noise)])
mean = [np.mean(totals[name], axis=0) for name in CHAINS]
rows.append(["mean", *(f"{v:.2f}" for v in mean[0]), f"{np.mean(list(PDAL.values())):.2f}", *(f"{v:.2f}" for v in mean[1])])
common.table(["sample", "type I %", "type II %", "total %", "kappa %", "PDAL total %", "with noise: type I %", "type II %", "total %", "kappa %"], rows)
