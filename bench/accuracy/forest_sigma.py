# SPDX-License-Identifier: GPL-3.0-or-later
"""How true the sigma of a cloud's terrain model is in forest, on clouds of an echo model that is not the program's: echoes of low plants closer than the
pulse is long merge with the ground's into one that lies too high by their share of the energy.

    forest_sigma.py [--seeds 3] [--first 0] [--densities 3 8 20] [--echoes 0.3 1.0] [--slope 0]

Two lines over the whole square, each off by 2 cm (sigma) in height; with --slope each off by 4 cm east and north too, on a hillside of this slope.
Open ground is 30 % of the square, understorey stands in half of the forest.
"""
import argparse
import sys

import laspy
import numpy as np
import scipy.spatial
import scipy.stats

import common

SIDE, FOREST = 160.0, 112.0      # m; forest is west of the second
ORIGIN = np.array([500000.0, 5300000.0])
TREES, RADIUS, HEIGHT = 300, (1.5, 3.5), (10, 25)   # per ha, m, m
PENETRATION, UNDERSTOREY, TALLEST = 0.4, 0.5, 1.5   # share of energy, share of the forest, m
LEAST_ENERGY = 0.1               # of an echo that is recorded
RANGE, LINE, ASIDE = 0.02, 0.02, 0.04  # m
MARGIN = 5.0                     # m from edges and the forest's edge that is not judged
CHAIN = [{"type": t} for t in ("readers.las", "quality.lines", "filters.ground", "terrain.dtm", "writers.gdal")]


def waves(x, y, random, lengths):
    return sum(a / 1.7 * np.sin(2 * np.pi * (x * np.cos(d) + y * np.sin(d)) / length + p)
               for length, a in lengths for d, p in zip(random.uniform(0, np.pi, 3), random.uniform(0, 2 * np.pi, 3)))


class Scene:
    def __init__(self, seed, slope):
        self.seed, self.slope = seed, slope
        r = np.random.default_rng(seed)
        count = int(TREES * SIDE * SIDE / 1e4)
        self.trees = scipy.spatial.cKDTree(r.uniform(0, SIDE, (count, 2)))
        self.radius, self.height = r.uniform(*RADIUS, count), r.uniform(*HEIGHT, count)

    def terrain(self, x, y):
        return 300 + self.slope * x + waves(x, y, np.random.default_rng(self.seed + 1000), ((150, 6), (60, 1.5), (25, 0.3), (9, 0.05), (3, 0.015)))

    def growth(self, x, y):
        """Of the understorey, normal; it stands where this is above the quantile."""
        r = np.random.default_rng(self.seed + 5)
        return sum(np.sin(2 * np.pi * (x * np.cos(d) + y * np.sin(d)) / length + p)
                   for length, d, p in zip(r.uniform(6, 20, 12), r.uniform(0, np.pi, 12), r.uniform(0, 2 * np.pi, 12))) / np.sqrt(6)

    def line(self, number, density, echo, r):
        """Columns x, y, z, return number, number of returns, line."""
        n = int(density * SIDE * SIDE / 2)
        x, y = r.uniform(0, SIDE, (2, n))
        forest, (away, tree) = x < FOREST, self.trees.query(np.c_[x, y])
        growth = self.growth(x, y) - scipy.stats.norm.ppf(1 - UNDERSTOREY)
        crown = np.where((away < self.radius[tree]) & forest, np.minimum(1, r.exponential(1 - PENETRATION, n) + 0.2), 0)
        plants = np.where((growth > 0) & forest, (1 - crown) * np.clip(r.normal(0.55, 0.25, n), 0, 1), 0)
        ground = np.maximum(1 - crown - plants, 0)
        of_crown, of_plants = self.height[tree] * (1 - 0.6 * r.uniform(0, 1, n)), np.clip(0.3 + 0.5 * growth, 0.2, 1) * TALLEST * np.sqrt(r.uniform(0, 1, n))
        merged = (plants > 0) & (of_plants < echo) & (plants + ground > LEAST_ENERGY)
        lift = np.where(merged, plants * of_plants / (plants + ground + 1e-9), 0)
        seen = np.stack([crown > LEAST_ENERGY, (plants > LEAST_ENERGY) & ~merged, np.where(merged, plants + ground, ground) > LEAST_ENERGY], axis=1)
        above = np.stack([of_crown, of_plants, lift], axis=1)
        pulse, which = np.nonzero(seen)
        east, north = r.normal(0, ASIDE, 2) if self.slope else (0, 0)
        z = self.terrain(x, y)[pulse] + above[pulse, which] + r.normal(0, LINE) + r.normal(0, RANGE, len(pulse))
        return np.c_[x[pulse] + east, y[pulse] + north, z, np.cumsum(seen, axis=1)[pulse, which], seen.sum(axis=1)[pulse], np.full(len(pulse), number)]


def write(folder, points):
    header = laspy.LasHeader(version="1.4", point_format=6)
    header.scales, header.offsets, header.global_encoding.wkt = [0.001] * 3, [*ORIGIN, 0], True
    las = laspy.LasData(header)
    las.x, las.y, las.z = points[:, 0] + ORIGIN[0], points[:, 1] + ORIGIN[1], points[:, 2]
    las.return_number, las.number_of_returns, las.point_source_id = points[:, 3].astype("u1"), points[:, 4].astype("u1"), points[:, 5].astype("u2")
    las.gps_time = np.arange(len(points)) * 1e-5
    las.write(folder / "cloud.las")
    (folder / "survey.toml").write_text('name = "cloud"\ncrs = "EPSG:32632"\n[[points]]\nfile = "cloud.las"\ncrs = "EPSG:32632"\n')


def judge(scene, density, echo):
    """Error, sigma, in forest, in understorey of each cell; what quality.lines says."""
    folder = common.scratch("forest_sigma")
    r = np.random.default_rng(scene.seed + 7000)
    write(folder, np.concatenate([scene.line(line, density, echo, r) for line in (1, 2)]))
    report = common.run(CHAIN, folder / "survey.toml", folder / "out")
    height, place = common.raster(folder / "out/dtm.vrt")
    sigma, _ = common.raster(folder / "out/dtm_quality.vrt")
    i, j = np.nonzero(np.isfinite(height))
    x, y = place.c + (j + 0.5) * place.a - ORIGIN[0], place.f + (i + 0.5) * place.e - ORIGIN[1]
    good = (np.minimum(x, y) > MARGIN) & (np.maximum(x, y) < SIDE - MARGIN) & (np.abs(x - FOREST) > MARGIN)
    i, j, x, y = i[good], j[good], x[good], y[good]
    forest = x < FOREST
    plants = forest & (scene.growth(x, y) > scipy.stats.norm.ppf(1 - UNDERSTOREY))
    return height[i, j] - scene.terrain(x, y), sigma[i, j], forest, plants, common.stage_of(report, "quality.lines")["findings"]


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--seeds", type=int, default=3)
    p.add_argument("--first", type=int, default=0)
    p.add_argument("--densities", type=float, nargs="+", default=[3, 8, 20])
    p.add_argument("--echoes", type=float, nargs="+", default=[0.3, 1.0])
    p.add_argument("--slope", type=float, default=0.0)
    given = p.parse_args()
    rows = []
    for density in given.densities:
        for echo in given.echoes:
            parts = []
            for seed in range(given.first, given.first + given.seeds):
                print(f"{density:g}/m2, echo {echo} m: seed {seed}", file=sys.stderr, flush=True)
                parts.append(judge(Scene(seed, given.slope), density, echo))
            error, sigma, forest, plants = (np.concatenate([part[k] for part in parts]) for k in range(4))
            shared = np.mean([part[4]["common_m"] or np.nan for part in parts])
            for name, here in {"open": ~forest, "forest": forest, "forest, plants": plants, "forest, none": forest & ~plants}.items():
                ratio = error[here] / sigma[here]
                rows.append([f"{density:g}", echo, name, int(here.sum()), f"{1e3 * shared:.0f}", f"{1e3 * error[here].mean():+.0f}", f"{1e3 * common.rms(error[here]):.0f}",
                             f"{1e3 * common.rms(sigma[here]):.0f}", f"{common.rms(ratio):.2f}", f"{100 * np.mean(np.abs(ratio) < 1):.0f}", f"{100 * np.mean(np.abs(ratio) < 2):.0f}"])
    common.table(["pulses/m2", "echo m", "cover", "cells", "common mm", "mean mm", "rms mm", "sigma mm", "error/sigma", "within 1 sigma %", "within 2 %"], rows)


if __name__ == "__main__":
    main()
