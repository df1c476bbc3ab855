# SPDX-License-Identifier: GPL-3.0-or-later
"""Ground filters over simulated scenes whose every return and terrain is known: errors of labels by cover and kind, terrain models against the
analytic terrain, and how true the stated probabilities and sigmas are.

    ground.py [--seeds 1 2 3] [--scene zoo] [--filters filters.smrf ...] [--chain 'NAME=[{"type": ...}, ...]' ...] [--no-noise] [--set KEY=VALUE ...]

Without --filters or --chain every ground filter of the program is judged, alone and behind filters.noise. Table rows are sums over the seeds;
numbers of the terrain are millimetres.
"""
import argparse
import json
import sys

import numpy as np
from scipy import spatial

import common

COVER = {1: "open", 2: "forest", 3: "steep", 4: "building", 5: "low vegetation", 6: "water", 7: "bridge"}  # truth/cover.tif
KIND = {3: "low vegetation", 4: "medium", 5: "high", 6: "building", 7: "low outlier", 9: "water", 14: "wire", 15: "mast", 17: "bridge", 18: "high outlier"}
GEOREFERENCE = [{"type": "readers.trajectory"}, {"type": "readers.laser"}, {"type": "georeference"}, {"type": "filters.returns"}]
PRODUCTS = [{"type": "terrain.dtm", "cell": "1 m"}, {"type": "writers.las", "compress": False, "scale": 0.0001}, {"type": "writers.gdal"}]
TRUE_LABELS, TRUE_PLACES = "true labels", "true labels and places"
LAWN = 0.15   # m: vegetation lower than that is mown grass, which filters.ground takes for ground unless told to find bare earth
MARGIN = 5.0  # m: cells nearer to the area's edge are not judged


def arguments():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--seeds", type=int, nargs="+", default=[1, 2, 3])
    p.add_argument("--scene", default="zoo")
    p.add_argument("--filters", nargs="*", default=[])
    p.add_argument("--chain", action="append", default=[], help="NAME=JSON list of stages")
    p.add_argument("--no-noise", action="store_true", help="filters alone, not behind filters.noise too")
    p.add_argument("--set", action="append", default=[], help="option of swath simulate, KEY=VALUE")
    p.add_argument("--folder", default="ground", help="name of the folder within the scratch folder")
    return p.parse_args()


class Found:
    """What one chain made of all seeds: columns of returns and of the terrain's cells."""

    def __init__(self):
        self.kind, self.cover, self.said, self.probability, self.lawn = [], [], [], [], []  # by return
        self.error, self.sigma, self.under = [], [], []                      # by cell
        self.without_height = dict.fromkeys(COVER, 0)

    def join(self):
        for name in ("kind", "cover", "said", "probability", "lawn", "error", "sigma", "under"):
            parts = getattr(self, name)
            setattr(self, name, np.concatenate(parts) if parts else np.array([]))


class Survey:
    """A simulated survey with its truth."""

    def __init__(self, folder, seed, scene, options, cell="1 m"):
        self.folder = common.simulate(folder, seed=seed, world__scene=scene, output__dtm_cell=cell, **options)
        self.truth = np.load(self.folder / "truth/returns.npy")
        self.terrain, self.place = common.raster(self.folder / "truth/dtm.tif")
        self.cover, _ = common.raster(self.folder / "truth/cover.tif")
        self.return_cover = np.nan_to_num(common.nearest(self.cover, self.place, self.truth["e"], self.truth["n"])).astype(int)
        self.kind = self.truth["cls"].astype(int)
        self.lawn = self.lawns()
        # The truth's raster is centred on the area.
        used = json.loads((self.folder / "truth/simulation.json").read_text())["options"]
        length, width, bearing = metres(used["world"]["length"]), metres(used["world"]["width"]), degrees(used["flight"]["direction"])
        rows, columns = self.terrain.shape
        east, north = np.meshgrid((np.arange(columns) + 0.5 - columns / 2) * self.place.a, (np.arange(rows) + 0.5 - rows / 2) * self.place.e)
        along, across = east * np.sin(bearing) + north * np.cos(bearing), east * np.cos(bearing) - north * np.sin(bearing)
        self.area = (np.abs(along) < length / 2 - MARGIN) & (np.abs(across) < width / 2 - MARGIN)


    def lawns(self):
        """True where low vegetation is lower than LAWN over the true ground returns around."""
        places = np.stack([self.truth[a] for a in ("e", "n")], axis=1)
        ground, low = self.kind == 2, np.flatnonzero(self.kind == 3)
        out = np.zeros(len(places), bool)
        if len(low):
            near = spatial.cKDTree(places[ground]).query(places[low], k=6)[1]
            out[low] = self.truth["h"][low] - np.median(self.truth["h"][ground][near], axis=1) < LAWN
        return out


def metres(text):
    number, unit = str(text).split()
    return float(number) * {"m": 1, "km": 1000}[unit]


def degrees(text):
    number, unit = str(text).split()
    return float(number) * {"deg": np.pi / 180, "rad": 1}[unit]


def add_terrain(found, survey, output):
    """Errors of the model's cells within the area."""
    i, j = np.nonzero(survey.area)
    x, y = survey.place.c + (j + 0.5) * survey.place.a, survey.place.f + (i + 0.5) * survey.place.e
    height, place = common.raster(output / "dtm.vrt")
    sigma, _ = common.raster(output / "dtm_quality.vrt")
    cover, modelled = survey.cover[survey.area].astype(int), common.nearest(height, place, x, y)
    known = np.isfinite(modelled)
    for key in COVER:
        found.without_height[key] += int(np.sum(~known & (cover == key)))
    found.error.append((modelled - survey.terrain[survey.area])[known])
    found.sigma.append(common.nearest(sigma, place, x, y)[known])
    found.under.append(cover[known])


def judge(found, survey, chain, folder):
    output = common.scratch(f"{folder}/run") / "out"
    common.run([*GEOREFERENCE, *chain, *PRODUCTS], survey.folder / "survey.toml", output)
    points = common.points_of(output)
    order = common.paired(points, survey.truth["t"] - 1e9, survey.truth["rn"])
    found.kind.append(survey.kind)
    found.cover.append(survey.return_cover)
    found.said.append(points["classification"][order] == 2)
    if "ground_probability" in points:
        found.probability.append(points["ground_probability"][order].astype(float))
        found.lawn.append(survey.lawn)
    add_terrain(found, survey, output)
    return points, order


def judge_true_labels(found, survey, places, folder):
    """What the terrain model is with every label right, the returns at `places`."""
    work = common.scratch(f"{folder}/labels")
    ground = survey.kind == 2
    common.write_las(work / "ground.las", *(axis[ground] for axis in places), np.full(ground.sum(), 2, np.uint8))
    (work / "survey.toml").write_text('name = "ground"\ncrs = "EPSG:32632"\n[[points]]\nfile = "ground.las"\ncrs = "EPSG:32632"\nline = 1\n')
    common.run([{"type": "readers.las"}, PRODUCTS[0], PRODUCTS[2]], work / "survey.toml", work / "out")
    add_terrain(found, survey, work / "out")


def share(part, of):
    return "-" if not np.any(of) else f"{100 * np.mean(part[of]):.2f}"


def label_tables(all_found):
    rows, covers, kinds = [], [], []
    for name, f in all_found.items():
        ground = f.kind == 2
        plain = f.kind != 3
        rows.append([name, len(ground), *common.cells(common.agreement(ground, f.said)), *common.cells(common.agreement(ground[plain], f.said[plain])),
                     share(f.said, f.kind == 7), share(f.said, f.kind == 18)])
        for key, cover in COVER.items():
            here = f.cover == key
            if here.any():
                covers.append([name, cover, here.sum(), share(ground, here), *common.cells(common.agreement(ground[here], f.said[here]))])
        kinds.append([name, *(share(f.said, f.kind == key) for key in KIND)])
    common.table(["chain", "returns", "type I %", "type II %", "total %", "kappa %", "without low vegetation: type I %", "type II %", "total %", "kappa %",
                  "low outliers taken %", "high outliers taken %"], rows)
    print("Labels by cover\n")
    common.table(["chain", "cover", "returns", "truly ground %", "type I %", "type II %", "total %", "kappa %"], covers)
    print("Taken for ground, % of each kind\n")
    common.table(["chain", *KIND.values()], kinds)


def terrain_table(all_found):
    print("Terrain model\n")
    rows = []
    for name, f in all_found.items():
        for key, cover in {0: "all", **COVER}.items():
            here = np.full(len(f.error), True) if key == 0 else f.under == key
            if not here.any():
                continue
            e, missing = 1e3 * f.error[here], sum(f.without_height.values()) if key == 0 else f.without_height[key]
            stated = here & (f.sigma > 0)
            ratio = f.error[stated] / f.sigma[stated]
            said = ["-"] * 3 if name in (TRUE_LABELS, TRUE_PLACES) or len(ratio) == 0 else [f"{common.rms(ratio):.2f}", f"{100 * np.mean(np.abs(ratio) < 1):.0f}", f"{100 * np.mean(np.abs(ratio) < 2):.0f}"]
            rows.append([name, cover, here.sum(), missing, f"{e.mean():+.0f}", f"{np.median(np.abs(e)):.0f}", f"{common.rms(e):.0f}", f"{np.quantile(np.abs(e), 0.95):.0f}", *said])
    common.table(["chain", "cover", "cells", "without height", "mean mm", "median abs mm", "rms mm", "95 % mm", "error/sigma", "within 1 sigma %", "within 2 %"], rows)


def probability_table(all_found):
    rows, summary = [], []
    for name, f in all_found.items():
        if len(f.probability) == 0:
            continue
        judged = np.isfinite(f.probability) & (f.probability >= 0) & (f.probability <= 1)
        p, ground = f.probability[judged], f.kind[judged] == 2
        mown = ground | f.lawn[judged]
        decile = np.minimum((10 * p).astype(int), 9)
        off = 0.0
        for k in range(10):
            here = decile == k
            if here.any():
                rows.append([name, f"{k / 10:.1f}-{(k + 1) / 10:.1f}", here.sum(), f"{100 * p[here].mean():.1f}", f"{100 * ground[here].mean():.1f}",
                             f"{100 * mown[here].mean():.1f}"])
                off += here.mean() * abs(p[here].mean() - ground[here].mean())
        summary.append([name, f"{100 * judged.mean():.1f}", f"{100 * off:.1f}", f"{np.mean((p - ground) ** 2):.4f}", f"{ground.mean() * (1 - ground.mean()):.4f}"])
    if rows:
        print("Stated probability of ground\n")
        common.table(["chain", "stated", "returns", "mean stated %", "truly ground %", "with vegetation under 0.15 m %"], rows)
        common.table(["chain", "judged %", "mean distance of the deciles, points of %", "Brier score", "that of the share alone"], summary)


def main():
    given = arguments()
    chains = {name: json.loads(stages) for name, _, stages in (c.partition("=") for c in given.chain)}
    if given.filters or not chains:
        chains = {**common.ground_chains(given.filters, not given.no_noise), **chains}
    options = dict(o.split("=", 1) for o in given.set)
    all_found = {name: Found() for name in [*chains, TRUE_LABELS, TRUE_PLACES]}
    for seed in given.seeds:
        survey = Survey(common.scratch(f"{given.folder}/survey"), seed, given.scene, options)
        for name, chain in chains.items():
            print(f"seed {seed}: {name}", file=sys.stderr, flush=True)
            points, order = judge(all_found[name], survey, chain, given.folder)
        judge_true_labels(all_found[TRUE_LABELS], survey, [points[a][order] for a in "xyz"], given.folder)
        judge_true_labels(all_found[TRUE_PLACES], survey, [survey.truth[a] for a in ("e", "n", "h")], given.folder)
    for found in all_found.values():
        found.join()
    label_tables({name: found for name, found in all_found.items() if name in chains})
    terrain_table(all_found)
    probability_table(all_found)


if __name__ == "__main__":
    main()
