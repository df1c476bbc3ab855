# SPDX-License-Identifier: GPL-3.0-or-later
"""Orthophotos and colours of simulated photographs against the truth: orthophoto.py SWATH [SEEDS] (rasterio, laspy, numpy).

From raw records: the block is adjusted, the cloud georeferenced by the true trajectory's records, coloured, and brought to orthophotos. Places are
compared by matching squares of 50 cells of open ground with truth/orthophoto.tif (least squares on grey values, smoothed over a pixel).
"""
import subprocess
import sys
import tempfile
from pathlib import Path

import laspy
import numpy as np
import rasterio
from rasterio.merge import merge

SIMULATION = ["world.scene=mixed", "world.length=300 m", "world.width=240 m", "flight.lines=3", "flight.cross_lines=1", "flight.height=400 m",
              "scanner.prf=60 kHz", "events.file=true", "events.interval=1.2 s", "camera.file=true", "camera.photos=true", "camera.columns=1500",
              "camera.rows=1125", "camera.f=50 mm", "camera.nominal_f=50 mm", "camera.pixel=32 um", "camera.k1=-2.1e-5"]
SQUARE = 50  # cells


def run(*words):
    done = subprocess.run([str(w) for w in words], capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"{' '.join(map(str, words))}\n{done.stderr}")


def mosaic(folder, kind=""):
    files = [f for f in sorted(folder.glob("*.tif")) if f.stem.endswith("_quality") == bool(kind)]
    opened = [rasterio.open(f) for f in files]
    values, transform = merge(opened)
    return values.astype(float), transform


def smoothed(grey, sigma):
    half = int(3 * sigma + 1)
    kernel = np.exp(-0.5 * (np.arange(-half, half + 1) / sigma) ** 2)
    kernel /= kernel.sum()
    for axis in (0, 1):
        grey = np.apply_along_axis(np.convolve, axis, grey, kernel, "same")
    return grey


def shifts(photo, truth, valid, cell):
    """East and north of each square of the photo less those of the truth, m, and the rows and columns of the squares' middles."""
    a, b = smoothed(photo, 2.5), smoothed(truth, 2.5)
    down, right = np.gradient(b)
    out = []
    for r in range(SQUARE // 2, a.shape[0] - SQUARE, SQUARE):
        for c in range(SQUARE // 2, a.shape[1] - SQUARE, SQUARE):
            w = np.s_[r:r + SQUARE, c:c + SQUARE]
            if not valid[w].all():
                continue
            gx, gy, d = right[w].ravel(), down[w].ravel(), (a[w] - b[w]).ravel()
            keep = np.ones(d.size, bool)
            for _ in range(4):
                x = np.linalg.lstsq(np.stack([-gx, -gy, np.ones_like(gx)], 1)[keep], d[keep], rcond=None)[0]
                rest = d + gx * x[0] + gy * x[1] - x[2]
                keep = np.abs(rest) < 3 * 1.4826 * np.median(np.abs(rest)) + 1e-9
            out.append((x[0] * cell, -x[1] * cell, r + SQUARE // 2, c + SQUARE // 2))
    return np.array(out)


def open_ground(folder, shape, transform):
    """Cells on open ground: there the terrain model is the surface."""
    with rasterio.open(folder / "survey/truth/cover.tif") as d:
        cover, to = d.read(1), ~d.transform
    columns, rows = np.meshgrid(np.arange(shape[1]) + 0.5, np.arange(shape[0]) + 0.5)
    x, y = transform * (columns, rows)
    c, r = (np.floor(v).astype(int) for v in to * (x, y))
    inside = (c >= 0) & (r >= 0) & (c < cover.shape[1]) & (r < cover.shape[0])
    return inside & (np.where(inside, cover[np.clip(r, 0, cover.shape[0] - 1), np.clip(c, 0, cover.shape[1] - 1)], 0) == 1)


def compare(folder, name):
    values, transform = mosaic(folder / "ortho" / name)
    quality, _ = mosaic(folder / "ortho" / name, "quality")
    with rasterio.open(folder / "survey/truth/orthophoto.tif") as d:
        truth, at, cell = d.read().astype(float), d.transform, d.transform.a
    c, r = round((at.c - transform.c) / cell), round((at.f - transform.f) / -cell)
    window = np.s_[:, r:r + truth.shape[1], c:c + truth.shape[2]]
    photo, sigma = values[window], quality[0][window[1:]]
    is_open = open_ground(folder, truth.shape[1:], at)
    found = shifts(photo[1], truth[1], (photo[3] > 0) & is_open, cell)
    stated = sigma[found[:, 2].astype(int), found[:, 3].astype(int)]
    radial = np.hypot(found[:, 0], found[:, 1])
    return radial, stated, np.abs(photo[1] - truth[1])[(photo[3] > 0) & is_open].mean()


def colours(folder):
    with rasterio.open(folder / "survey/truth/orthophoto.tif") as d:
        truth, at, cell = d.read(2).astype(float), d.transform, d.transform.a
    differences, black, n = [], 0, 0
    for f in sorted((folder / "coloured/points").glob("*.la[sz]")):
        las = laspy.read(f)
        green = np.asarray(las.green) / 256
        i, j = ((np.asarray(las.x) - at.c) / cell).astype(int), ((at.f - np.asarray(las.y)) / cell).astype(int)
        has = (np.asarray(las.red) > 0) | (green > 0)
        black, n = black + (~has).sum(), n + len(has)
        use = has & (np.asarray(las.return_number) == 1) & (i >= 0) & (j >= 0) & (i < truth.shape[1]) & (j < truth.shape[0])
        differences.append(np.abs(green[use] - truth[j[use], i[use]]))
    return np.mean(np.concatenate(differences)), black / n


def main():
    swath, seeds = Path(sys.argv[1]).resolve(), int(sys.argv[2]) if len(sys.argv) > 2 else 1
    sums = {}
    for seed in range(1, seeds + 1):
        with tempfile.TemporaryDirectory() as scratch:
            folder = Path(scratch)
            run(swath, "simulate", folder / "survey", "--quiet", f"--set=seed={seed}", *[f"--set={s}" for s in SIMULATION])
            run(swath, "run", "block", "--survey", folder / "survey/survey.toml", "--output", folder / "block", "--quiet")
            run(swath, "run", "georeference", "--survey", folder / "survey/survey.toml", "--output", folder / "cloud", "--quiet")
            photos = ["--photos", folder / "survey/photos", "--orientation", folder / "block/block/orientation.csv", "--camera",
                      folder / "block/block/camera.toml"]
            with rasterio.open(folder / "survey/truth/orthophoto.tif") as d:
                cell = f"{d.transform.a:g} m"
            run(swath, "orthophoto", folder / "cloud/points", *photos, "--pixel", cell, "--output", folder / "ortho", "--quiet")
            run(swath, "colour", folder / "cloud/points", *photos, "--output", folder / "coloured", "--quiet")
            for name in ("orthophoto", "true_orthophoto"):
                radial, stated, grey = compare(folder, name)
                rms, ratio = np.sqrt((radial ** 2).mean()), np.sqrt(((radial / stated) ** 2).mean())
                sums.setdefault(name, []).append((ratio, rms))
                print(f"seed {seed} {name}: cells of {cell}, {len(radial)} squares, off by {100 * rms:.1f} cm (rms, radial), stated "
                      f"{100 * np.sqrt((stated ** 2).mean()):.1f} cm, error/sigma {ratio:.2f}, grey values {grey:.1f} of 255 off", flush=True)
            grey, black = colours(folder)
            print(f"seed {seed} points: grey values {grey:.1f} of 255 off, {100 * black:.1f} % without a colour", flush=True)
    for name, rows in sums.items():
        print(f"{name}: error/sigma {np.sqrt(np.mean([r[0] ** 2 for r in rows])):.2f} over {len(rows)} seeds")


if __name__ == "__main__":
    main()
