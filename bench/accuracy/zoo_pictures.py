# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of the zoo: the true ground as a hillshade (writers.picture) and the classes of the highest returns, zoo_SEED_relief.png and
zoo_SEED_classes.png in the scratch folder.

    zoo_pictures.py [SEED ...]
"""
import sys
import warnings

import numpy as np
import rasterio

import common
from ground import Survey

PIXEL = 1.0  # m
COLOURS = {0: (255, 255, 255), 2: (196, 164, 120), 3: (190, 220, 110), 4: (120, 180, 80), 5: (40, 120, 50), 6: (200, 60, 50), 7: (255, 0, 255),
           9: (70, 130, 220), 14: (20, 20, 20), 15: (20, 20, 20), 17: (240, 150, 30), 18: (140, 0, 200)}
SHOWN_FIRST = [18, 7, 14, 15, 17, 6, 5, 4, 3, 9, 2]  # class of a pixel: the first of these that it holds


def write_png(file, rgb):
    warnings.simplefilter("ignore", rasterio.errors.NotGeoreferencedWarning)
    with rasterio.open(file, "w", driver="PNG", height=rgb.shape[1], width=rgb.shape[2], count=3, dtype="uint8", ZLEVEL=9) as out:
        out.write(rgb)


def shrink(file, small, step=16):
    """The picture with 16 levels per channel."""
    warnings.simplefilter("ignore", rasterio.errors.NotGeoreferencedWarning)
    with rasterio.open(file) as source:
        pixels = source.read()[:3]
    write_png(small, np.minimum(255, np.round(pixels / step) * step).astype(np.uint8))


folder = common.scratch("zoo_pictures")
for seed in [int(v) for v in sys.argv[1:]] or [1]:
    survey = Survey(folder / f"survey_{seed}", seed, "zoo", {})
    truth, kind = survey.truth, survey.kind
    ground = kind == 2
    common.write_las(folder / "ground.las", *(truth[a][ground] for a in "enh"), np.full(ground.sum(), 2, np.uint8))
    (folder / "survey.toml").write_text('name = "ground"\ncrs = "EPSG:32632"\n[[points]]\nfile = "ground.las"\ncrs = "EPSG:32632"\nline = 1\n')
    output = common.scratch("zoo_pictures/out") / "run"
    common.run([{"type": "readers.las"}, {"type": "terrain.dtm"}, {"type": "terrain.contours", "min_length": "20 m"}, {"type": "writers.picture", "max_side": 800}],
               folder / "survey.toml", output)
    shrink(output / "relief.png", folder / f"zoo_{seed}_relief.png")
    west, north = truth["e"].min(), truth["n"].max()
    column, row = ((truth["e"] - west) / PIXEL).astype(int), ((north - truth["n"]) / PIXEL).astype(int)
    classes = np.zeros((row.max() + 1, column.max() + 1), np.uint8)
    for key in reversed(SHOWN_FIRST):
        here = kind == key
        classes[row[here], column[here]] = key
    rgb = np.zeros((3, *classes.shape), np.uint8)
    for key, colour in COLOURS.items():
        rgb[:, classes == key] = np.array(colour, np.uint8)[:, None]
    write_png(folder / f"zoo_{seed}_classes.png", rgb)
    print(folder / f"zoo_{seed}_relief.png", folder / f"zoo_{seed}_classes.png")
