# SPDX-License-Identifier: GPL-3.0-or-later
"""Seven samples of the ISPRS filter test: ground by every ground filter with its defaults, with and without noise removal before it, against the reference labels."""
import laspy
import numpy as np

import common

PDAL_SMRF = {11: 9.9, 21: 2.5, 24: 4.1, 41: 6.5, 52: 4.5, 54: 7.0, 71: 3.7}
FILTERS = ["smrf", "ptd", "robust", "pmf", "csf"]
CHAINS = {name: [{"type": f"filters.{name}"}] for name in FILTERS}
CHAINS |= {f"noise + {name}": [{"type": "filters.noise"}, *chain] for name, chain in CHAINS.items()}
FIGURES = ["type I %", "type II %", "total %", "kappa %"]

data = common.reference("isprs")
folder = common.scratch("isprs")
figures = {name: [] for name in CHAINS}
for sample in PDAL_SMRF:
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
        figures[name].append([100 * lost / ground.sum(), 100 * taken / (~ground).sum(), 100 * (1 - agree), 100 * (agree - chance) / (1 - chance)])

rows = []
for name in FILTERS:
    both = np.hstack([figures[name], figures[f"noise + {name}"]])
    for sample, row in zip([*PDAL_SMRF, "mean"], [*both, both.mean(axis=0)]):
        rows.append([name, sample, *(f"{v:.2f}" for v in row)])
common.table(["filter", "sample", *FIGURES, *(f"with noise: {FIGURES[0]}" if i == 0 else figure for i, figure in enumerate(FIGURES))], rows)

print("PDAL's SMRF with its defaults, total %:")
common.table([*map(str, PDAL_SMRF), "mean"], [[*PDAL_SMRF.values(), f"{np.mean(list(PDAL_SMRF.values())):.2f}"]])
