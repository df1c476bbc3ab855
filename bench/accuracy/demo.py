# SPDX-License-Identifier: GPL-3.0-or-later
"""The README's simulated survey with its delivered trajectory, raw records to products: what report.truth tells, and its picture as the README shows it, relief_SEED.png."""
import sys
import warnings

import numpy as np
import rasterio

import common


def shrink(picture, small, step=8):
    """The picture with 32 levels per channel: half of the bytes, the same to the eye."""
    warnings.simplefilter("ignore", rasterio.errors.NotGeoreferencedWarning)
    with rasterio.open(picture) as file:
        pixels = file.read()
    pixels = np.minimum(255, np.round(pixels / step) * step).astype(np.uint8)
    with rasterio.open(small, "w", driver="PNG", height=pixels.shape[1], width=pixels.shape[2], count=len(pixels), dtype="uint8", ZLEVEL=9) as file:
        file.write(pixels)


folder = common.scratch("demo")
seeds = [int(v) for v in sys.argv[1:]] or [1]
rows = []
for seed in seeds:
    survey = common.simulate(folder / "survey", seed=seed)
    report = common.run(common.ROOT / "configs/survey_sbet.toml", survey / "survey.toml", common.scratch("demo/products"))
    found = common.stage_of(report, "report.truth")["findings"]
    points, ground, dtm = found["points"], found["ground"], found["dtm"]
    rows.append([seed, points["compared"], " ".join(f"{1e3 * points[f'mean_{a}_m']:+.1f}" for a in ("east", "north", "up")),
                 " ".join(f"{1e3 * points[f'rms_{a}_m']:.1f}" for a in ("east", "north", "up")), f"{100 * found['rms_3d']:.2f}",
                 f"{points['error_over_sigma_h']:.2f} {points['error_over_sigma_v']:.2f}",
                 " ".join(f"{ground[k + '_percent']:.2f}" for k in ("type_1", "type_2", "total_error")), f"{ground['kappa_percent']:.1f}",
                 f"{1e3 * dtm['mean_m']:+.1f}", f"{1e3 * dtm['median_abs_m']:.0f}", f"{1e3 * dtm['rms_m']:.1f}", f"{dtm['error_over_sigma']:.2f}"])
    shrink(folder / "products/relief.png", folder / f"relief_{seed}.png")
common.table(["seed", "returns", "mean E N U mm", "rms E N U mm", "RMS 3D cm", "error/sigma h v", "ground type I, II, total %", "kappa %", "DTM mean mm",
              "median abs mm", "rms mm", "error/sigma"], rows)
