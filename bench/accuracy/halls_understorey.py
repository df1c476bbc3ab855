# SPDX-License-Identifier: GPL-3.0-or-later
"""What filters.ground makes of halls and of an understorey, with its defaults.

    halls_understorey.py [--seeds 1 2] [--halls 80x40 150x90 ...] [--draws 3] [--only halls|understorey]

Halls (length x width, m) stand in the zoo, as it is and on level ground. Each is judged whole and cut by the rim of the data along both of its axes, so
that a quarter, a half or three quarters of it are left. The understorey of 0.5 to 2 m stands under a canopy that 30 % of the pulses pass to the ground
(echo_scenes.py, 3 pulses/m2), in draws that no fit has seen; the terrain model is compared with the analytic terrain.
"""
import argparse

import laspy
import numpy as np
from scipy import ndimage

import common
import echo_scenes
import ground

GROUNDS = {"zoo": {}, "level": {"world__relief": "0 m", "world__slope": 0}}
WIDE_AREA = {"world__length": "1000 m", "world__width": "800 m"}  # for halls that the zoo's own has no room for
LEFT = (0.25, 0.5, 0.75)  # share of a hall that the rim leaves
AROUND = 150.0            # m about a hall that a cut cloud holds
BESIDE = 30.0             # m about a hall in which lost ground is counted
STAYS = 1.0               # % of a roof taken for ground from which a hall counts as one that stays
UNDERSTOREY = ("understorey", "understorey, slope", "understorey, wide", "understorey, closed")
FIRST_DRAW = 900          # seeds of draws that ground_calibration.py does not know
FILTERS = [{"type": "filters.noise"}, {"type": "filters.ground"}]
WRITE = [{"type": "writers.las", "compress": False, "scale": 0.0001}]


def write(folder, rows):
    """Columns east, north, height, return number, number of returns, line."""
    header = laspy.LasHeader(version="1.4", point_format=6)
    header.scales, header.offsets, header.global_encoding.wkt = [1e-4] * 3, np.floor(rows[:, :3].min(axis=0)), True
    header.global_encoding.gps_time_type = laspy.header.GpsTimeType.STANDARD
    las = laspy.LasData(header)
    las.x, las.y, las.z = rows[:, :3].T
    las.return_number, las.number_of_returns, las.point_source_id = rows[:, 3].astype("u1"), rows[:, 4].astype("u1"), rows[:, 5].astype("u2")
    las.gps_time = np.arange(len(rows), dtype=float)
    las.write(folder / "cloud.las")
    (folder / "survey.toml").write_text('name = "cloud"\ncrs = "EPSG:32632"\n[[points]]\nfile = "cloud.las"\ncrs = "EPSG:32632"\n')


def labelled(folder, rows, products=()):
    """True where a row is taken for ground; the report."""
    write(folder, rows)
    report = common.run([{"type": "readers.las"}, *FILTERS, *products, *WRITE], folder / "survey.toml", folder / "out")
    points = common.points_of(folder / "out")
    said = np.zeros(len(rows), bool)
    said[np.round(points["gps_time"]).astype(int)] = points["classification"] == 2
    return said, report


def hall_of(survey):
    """Rows of the largest building's returns, and two axes with the hall between 0 and its size."""
    parts, _ = ndimage.label(survey.cover == 4)
    largest = 1 + np.argmax(np.bincount(parts[parts > 0])[1:])
    part = common.nearest(ndimage.binary_dilation(parts == largest).astype(float), survey.place, survey.truth["e"], survey.truth["n"])
    roof = (part == 1) & (survey.kind == 6)
    at = np.stack([survey.truth["e"], survey.truth["n"]], axis=1)
    middle = at[roof].mean(axis=0)
    axes = np.linalg.eigh(np.cov((at[roof] - middle).T))[1][:, ::-1]
    along = (at - middle) @ axes
    low, high = along[roof].min(axis=0), along[roof].max(axis=0)
    return roof, along - low, high - low


def judge_halls(length, width, seeds):
    rows = []
    for name, options in GROUNDS.items():
        found = {}
        for seed in seeds:
            wide = WIDE_AREA if np.hypot(length, width) > 380 or length > 180 else {}
            survey = ground.Survey(common.scratch("halls/survey"), seed, "zoo", {**options, **wide, "world__hall_length": f"{length} m", "world__hall_width": f"{width} m"})
            t = survey.truth
            cloud = np.stack([t[c].astype(float) for c in ("e", "n", "h", "rn", "nr", "line")], axis=1)
            cloud[:, 2] += np.random.default_rng(seed).normal(0, 0.02, len(cloud))
            roof, along, size = hall_of(survey)
            near = np.all((along > -AROUND) & (along < size + AROUND), axis=1)
            cuts = {"whole": near, **{f"{share:.2f} of its {('length', 'width')[axis]}": near & (along[:, axis] < share * size[axis]) for axis in (0, 1) for share in LEFT}}
            for cut, held in cuts.items():
                said, report = labelled(common.scratch("halls/run"), cloud[held])
                beside = np.all((along > -BESIDE) & (along < size + BESIDE), axis=1)[held] & (survey.kind[held] == 2)
                warned = any("between walls" in what for what in common.stage_of(report, "filters.ground").get("tally", {}))
                found.setdefault(cut, []).append((said[roof[held]], ~said[beside], warned))
        for cut, parts in found.items():
            taken, lost = np.concatenate([p[0] for p in parts]), np.concatenate([p[1] for p in parts])
            stay = sum(100 * p[0].mean() > STAYS for p in parts)
            rows.append([f"{length} x {width} m", name, cut, len(parts), stay, f"{100 * taken.mean():.2f}", f"{100 * lost.mean():.2f}", sum(p[2] for p in parts)])
    return rows


def judge_understorey(name, draws):
    low_taken, low_count, lost, ground_count, errors = 0, 0, 0, 0, []
    slope = echo_scenes.SCENES[name][2]
    for seed in range(FIRST_DRAW, FIRST_DRAW + draws):
        rows, is_ground = echo_scenes.cloud(name, seed)
        folder = common.scratch("understorey/run")
        said, _ = labelled(folder, rows + np.array([500000.0, 5300000.0, 0, 0, 0, 0]), [{"type": "terrain.dtm", "cell": "1 m"}, {"type": "writers.gdal"}])
        above = rows[:, 2] - echo_scenes.terrain(seed, slope, rows[:, 0], rows[:, 1])
        low = ~is_ground & (above < 2.3)
        low_taken, low_count = low_taken + np.sum(low & said), low_count + low.sum()
        lost, ground_count = lost + np.sum(is_ground & ~said), ground_count + is_ground.sum()
        height, place = common.raster(folder / "out/dtm.vrt")
        i, j = np.nonzero(np.isfinite(height))
        x, y = place.c + (j + 0.5) * place.a - 500000.0, place.f + (i + 0.5) * place.e - 5300000.0
        inside = (np.minimum(x, y) > ground.MARGIN) & (np.maximum(x, y) < echo_scenes.SIDE - ground.MARGIN)
        errors.append((height[i, j] - echo_scenes.terrain(seed, slope, x, y))[inside])
    e = 1e3 * np.concatenate(errors)
    return [name, draws, f"{100 * lost / ground_count:.2f}", f"{100 * low_taken / low_count:.2f}", f"{e.mean():+.0f}", f"{common.rms(e):.0f}", f"{np.quantile(np.abs(e), 0.95):.0f}"]


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--seeds", type=int, nargs="+", default=[1, 2])
    p.add_argument("--halls", nargs="+", default=["80x40", "150x90"])
    p.add_argument("--draws", type=int, default=3)
    p.add_argument("--only", choices=("halls", "understorey"))
    given = p.parse_args()
    if given.only != "understorey":
        rows = [row for hall in given.halls for row in judge_halls(*map(int, hall.split("x")), given.seeds)]
        common.table(["hall", "ground", "of it in the data", "scenes", "stay ground", "roof taken for ground %", f"ground lost within {BESIDE:.0f} m %", "warned"], rows)
    if given.only != "halls":
        common.table(["understorey of 0.5 to 2 m", "draws", "ground lost %", "understorey taken for ground %", "DTM mean mm", "rms mm", "95 % mm"],
                     [judge_understorey(name, given.draws) for name in UNDERSTOREY])


if __name__ == "__main__":
    main()
