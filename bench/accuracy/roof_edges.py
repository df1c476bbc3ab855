# SPDX-License-Identifier: GPL-3.0-or-later
"""Planimetry by roof edges: simulated surveys moved by known amounts, as quality.points finds it by surveyed roofs.

    roof_edges.py [--seeds 20] [--scenes town airfield] [--patterns triangle conical ...] [--prf 8 25 100] [--errors] [--set KEY=VALUE ...]

Each survey is moved by up to 0.3 m in a direction of its seed; its targets, facets of roofs that the simulator surveys with 1 cm, go the other way. The records are
georeferenced with trajectory and calibration that are true (white noise of range, angle and beam stays), so that the put-in shift is the cloud's. With --errors the
delivered trajectory has the simulator's errors, and the truth of a survey is the put-in shift and the mean error of its returns from buildings.
"""
import argparse

import numpy as np

import common

STAGES = [{"type": "readers.trajectory"}, {"type": "readers.laser"}, {"type": "georeference"}, {"type": "filters.returns"}, {"type": "quality.points"}]
TRUE = {"mounting.deliver": "truth", "noise.horizontal": "0 m", "noise.vertical": "0 m", "noise.roll_pitch": "0 deg", "noise.heading": "0 deg"}
OPTIONS = {"world.length": "300 m", "world.width": "260 m", "flight.lines": 2, "imu.file": "false", "gnss.file": "false", "control.sigma": "0.01 m", "control.points": 0}


def moved_targets(survey, shift):
    """Writes roofs.csv, the targets moved by -shift, and names them check points in survey.toml."""
    lines = (survey / "control.csv").read_text().splitlines()
    head, rows = lines[0].split(","), [line.split(",") for line in lines[1:]]
    x, y = head.index("x"), head.index("y")
    for r in rows:
        r[x], r[y] = f"{float(r[x]) - shift[0]:.4f}", f"{float(r[y]) - shift[1]:.4f}"
    (survey / "roofs.csv").write_text("\n".join([",".join(head), *(",".join(r) for r in rows)]) + "\n")
    text = (survey / "survey.toml").read_text()
    (survey / "survey.toml").write_text(text.replace('file = "control.csv"\n', 'file = "roofs.csv"\nuse = "check"\n'))


def cloud_error(survey, output):
    """Mean horizontal error of the returns from buildings."""
    points, truth = common.points_of(output), np.load(survey / "truth/returns.npy")
    order = common.paired(points, common.adjusted(truth["t"]), truth["rn"])
    errors = common.errors_of(points, order, truth)[truth["cls"] == 6]
    return errors[:, :2].mean(axis=0)


def case(scene, pattern, prf, seeds, errors, options):
    means, roofs, states = [], [], {}
    density = []
    for seed in range(1, seeds + 1):
        random = np.random.default_rng(1000 + seed)
        folder = common.scratch("roof_edges")
        given = {**OPTIONS, **({} if errors else TRUE), "world.scene": scene, "scanner.pattern": pattern, "scanner.prf": f"{prf} kHz", "scanner.frequency": f"{20 * np.sqrt(prf / 8):.1f} Hz",
                 "control.targets": 12 if scene == "town" else 4, "output.truth_returns": str(errors).lower(), **options}
        survey = common.simulate(folder / "survey", seed=seed, **given)
        turn, size = random.uniform(0, 2 * np.pi), random.uniform(0, 0.3)
        shift = size * np.array([np.cos(turn), np.sin(turn)])
        moved_targets(survey, shift)
        stages = STAGES + ([{"type": "writers.las"}] if errors else [{"type": "quality.density"}])
        report = common.run(stages, survey / "survey.toml", folder / "out")
        found = common.stage_of(report, "quality.points")["findings"]
        if errors:
            shift = shift + cloud_error(survey, folder / "out")
        else:
            density.append(common.stage_of(report, "quality.density")["findings"]["density"])
        for r in found["roofs"]:
            states[r["state"]] = states.get(r["state"], 0) + 1
            if r["state"] == "both":
                roofs.append([r["east_m"] - shift[0], r["north_m"] - shift[1], r["sigma_east_m"], r["sigma_north_m"]])
            if r["state"] == "one":
                a = np.radians(r["azimuth_deg"])
                roofs.append([r["along_m"] - shift @ [np.sin(a), np.cos(a)], np.nan, r["sigma_along_m"], np.nan])
        m = found["planimetry"]
        if "east_m" in m:
            means.append([m["east_m"] - shift[0], m["north_m"] - shift[1], m["sigma_east_m"], m["sigma_north_m"]])
    one, mean = np.array(roofs), np.array(means).reshape(-1, 4)

    def figures(a):
        e, s = a[:, :2].ravel(), a[:, 2:].ravel()
        e, s = e[np.isfinite(e)], s[np.isfinite(e)]
        return [f"{100 * common.rms(e):.1f}", f"{100 * np.abs(e).max():.0f}", f"{common.rms(e / s):.2f}"]

    return [scene, pattern, f"{np.mean(density):.1f}" if density else f"{prf} kHz", len(mean), *(states.get(k, 0) for k in ("both", "one", "few_edges", "not_there", "disagrees")),
            *figures(one), *figures(mean)]


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--seeds", type=int, default=20)
    p.add_argument("--scenes", nargs="+", default=["town", "airfield"])
    p.add_argument("--patterns", nargs="+", default=["triangle"])
    p.add_argument("--prf", type=float, nargs="+", default=[8, 25, 100])
    p.add_argument("--errors", action="store_true")
    p.add_argument("--set", action="append", default=[])
    given = p.parse_args()
    options = dict(o.split("=", 1) for o in given.set)
    rows = [case(scene, pattern, prf, given.seeds, given.errors, options) for scene in given.scenes for pattern in given.patterns for prf in given.prf]
    common.table(["scene", "scanner", "first returns per m2", "surveys", "roofs", "one component", "few edges", "not there", "disagree", "a roof: rms per axis cm", "largest cm", "error / sigma",
                  "the mean: rms per axis cm", "largest cm", "error / sigma"], rows)


if __name__ == "__main__":
    main()
