# SPDX-License-Identifier: GPL-3.0-or-later
"""pylasr's nearest chain: read, isolated voxels, cloth simulation, triangulation of the ground, DTM of 1 m; or one of its parts.

    python bench/pylasr_chain.py CLOUD.las DTM.tif [CLOTH_RESOLUTION [all|read|noise|ground|terrain]]

terrain: triangulation and DTM of the points that the file itself has as ground.
"""
import sys

import pylasr

cloth = float(sys.argv[3]) if len(sys.argv) > 3 else 0.5  # 0.5 m is pylasr's default
part = sys.argv[4] if len(sys.argv) > 4 else "all"
chain = pylasr.reader_coverage()
if part == "read":
    chain += pylasr.summarise()
if part in ("noise", "all"):
    chain += pylasr.classify_with_ivf()
if part in ("ground", "all"):
    chain += pylasr.classify_with_csf(cloth_resolution=cloth, filter=["-drop_class 18"])
if part in ("terrain", "all"):
    ground = pylasr.triangulate(50.0, ["-keep_class 2"])
    chain += ground
    chain += pylasr.rasterize_triangulation(ground, 1.0, sys.argv[2])
chain.set_sequential_strategy()
chain.set_progress(False)
pylasr.execute(chain, sys.argv[1])
