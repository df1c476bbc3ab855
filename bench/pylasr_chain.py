# SPDX-License-Identifier: GPL-3.0-or-later
"""pylasr's nearest chain: read, isolated voxels, cloth simulation, triangulation of the ground, DTM of 1 m.

    python bench/pylasr_chain.py CLOUD.las DTM.tif [CLOTH_RESOLUTION]
"""
import sys

import pylasr

cloth = float(sys.argv[3]) if len(sys.argv) > 3 else 0.5  # 0.5 m is pylasr's default
chain = pylasr.reader_coverage() + pylasr.classify_with_ivf()
chain += pylasr.classify_with_csf(cloth_resolution=cloth, filter=["-drop_class 18"])
ground = pylasr.triangulate(50.0, ["-keep_class 2"])
chain += ground
chain += pylasr.rasterize_triangulation(ground, 1.0, sys.argv[2])
chain.set_sequential_strategy()
chain.set_progress(False)
pylasr.execute(chain, sys.argv[1])
