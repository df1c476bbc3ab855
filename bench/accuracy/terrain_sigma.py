# SPDX-License-Identifier: GPL-3.0-or-later
"""How true the terrain model's sigmas are over many surveys of small zoos: error over sigma by cover, at other noise and density.

    terrain_sigma.py [--seeds 12] [--first 11]

A survey's trajectory errs nearly alike all along it, so that one survey tells one draw of that error: only many tell whether the sigma is true.
"""
import argparse
import sys

import numpy as np

import common
import ground

SETTINGS = {"as simulated": {},
            "trajectory without error": {"noise__horizontal": "0.1 mm", "noise__vertical": "0.1 mm", "noise__roll_pitch": "0.00001 deg", "noise__heading": "0.00001 deg"},
            "range noise 5 cm": {"noise__range": "5 cm"},
            "a quarter of the density": {"scanner__prf": "25 kHz", "scanner__frequency": "30 Hz"}}
COVERS = (1, 2, 3, 5, 4)


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--seeds", type=int, default=12)
    p.add_argument("--first", type=int, default=11)
    p.add_argument("--settings", nargs="*", default=list(SETTINGS))
    given = p.parse_args()
    rows = []
    for name in given.settings:
        found = ground.Found()
        for seed in range(given.first, given.first + given.seeds):
            print(f"{name}: seed {seed}", file=sys.stderr, flush=True)
            options = {"world__length": "240 m", "world__width": "240 m", **SETTINGS[name]}
            survey = ground.Survey(common.scratch("terrain_sigma/survey"), seed, "zoo", options)
            ground.judge(found, survey, [{"type": "filters.ground"}], "terrain_sigma")
        found.join()
        for key in COVERS:
            here = (found.under == key) & (found.sigma > 0)
            if not here.any():
                continue
            ratio = found.error[here] / found.sigma[here]
            rows.append([name, ground.COVER[key], int(here.sum()), f"{1e3 * common.rms(found.error[here]):.0f}", f"{1e3 * common.rms(found.sigma[here]):.0f}",
                         f"{common.rms(ratio):.2f}", f"{100 * np.mean(np.abs(ratio) < 1):.0f}", f"{100 * np.mean(np.abs(ratio) < 2):.0f}"])
    common.table(["survey", "cover", "cells", "rms mm", "sigma mm", "error/sigma", "within 1 sigma %", "within 2 %"], rows)


if __name__ == "__main__":
    main()
