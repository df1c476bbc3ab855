# SPDX-License-Identifier: GPL-3.0-or-later
"""Seven samples of the ISPRS filter test: every ground filter with its defaults against the reference labels.

    isprs.py [FILTER ...]     filters.smrf and the like; without any: all of the program
"""
import sys

import laspy
import numpy as np

import common

PDAL = {11: 9.9, 21: 2.5, 24: 4.1, 41: 6.5, 52: 4.5, 54: 7.0, 71: 3.7}  # total error of PDAL's SMRF with its defaults, %

data = common.reference("isprs")
folder = common.scratch("isprs")
chains = common.ground_chains(sys.argv[1:])
found = {name: [] for name in chains}
for sample in PDAL:
    source = laspy.read(data / f"samp{sample}-utm.las")
    ground = np.asarray(source.classification) == 2
    count = len(ground)
    # Numbered by their time, so that every point is found again.
    common.write_las(folder / f"{sample}.las", source.x, source.y, source.z, np.zeros(count, np.uint8), 0.01, np.arange(count, dtype=float))
    (folder / "survey.toml").write_text(f'name = "samp{sample}"\ncrs = "EPSG:32632"\n[[points]]\nfile = "{sample}.las"\ncrs = "EPSG:32632"\nline = 1\n')
    for name, chain in chains.items():
        output = folder / f"{sample} {name}"
        common.run([{"type": "readers.las"}, *chain, {"type": "writers.las", "compress": False}], folder / "survey.toml", output)
        points = common.points_of(output)
        assert len(points["x"]) == count
        said = np.zeros(count, bool)
        said[np.round(points["gps_time"]).astype(int)] = points["classification"] == 2
        found[name].append(common.agreement(ground, said))
for name in chains:
    print(f"\n{name}")
    rows = [[sample, *common.cells(one), PDAL[sample]] for sample, one in zip(PDAL, found[name])]
    common.table(["sample", "type I %", "type II %", "total %", "kappa %", "PDAL's SMRF total %"], [*rows, ["mean", *common.cells(np.mean(found[name], axis=0)), f"{np.mean(list(PDAL.values())):.2f}"]])
print("Means over the samples")
common.table(["chain", "type I %", "type II %", "total %", "kappa %"], [[name, *common.cells(np.mean(all_samples, axis=0))] for name, all_samples in found.items()])
