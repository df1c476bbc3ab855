# SPDX-License-Identifier: GPL-3.0-or-later
"""Planimetry by roof edges: clouds of simulated halls moved by known amounts, as quality.points finds it by check targets.

    roof_edges.py [--seeds 1 2 3 4] [--shifts 0 0.05 0.10] [--scene town] [--set KEY=VALUE ...]

The returns are georeferenced with the delivered trajectory and classes are not used. Check targets are the corners of all facets of truth, moved and not moved.
"""
import argparse

import numpy as np

import common

STAGES = [{"type": "readers.trajectory"}, {"type": "readers.laser"}, {"type": "georeference"}, {"type": "filters.returns"}, {"type": "quality.points"}]


def targets_of(survey):
    lines = (survey / "control.csv").read_text().splitlines()
    head, rows = lines[0].split(","), [line.split(",") for line in lines[1:]]
    return head, [r for r in rows if r[1]]


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--seeds", type=int, nargs="+", default=[1, 2, 3, 4])
    p.add_argument("--shifts", type=float, nargs="+", default=[0.0, 0.05, 0.10])
    p.add_argument("--scene", default="town")
    p.add_argument("--targets", type=int, default=8)
    p.add_argument("--set", action="append", default=[])
    given = p.parse_args()
    options = {"imu.file": "false", "gnss.file": "false", "control.targets": given.targets, "control.sigma": "0.01 m", **dict(o.split("=", 1) for o in given.set)}
    rows = []
    for shift in given.shifts:
        mean_errors, sigmas, single, single_sigma, roofs = [], [], [], [], 0
        for seed in given.seeds:
            folder = common.scratch("roof_edges")
            survey = common.simulate(folder / "survey", seed=seed, world__scene=given.scene, **options)
            head, corners = targets_of(survey)
            turn = 2.4 * seed
            moved = shift * np.array([np.cos(turn), np.sin(turn)])  # of the cloud: the targets go the other way
            x, y = head.index("x"), head.index("y")
            for r in corners:
                r[1], r[x], r[y] = f"check {r[1]}", f"{float(r[x]) - moved[0]:.4f}", f"{float(r[y]) - moved[1]:.4f}"
            (survey / "roofs.csv").write_text("\n".join([",".join(head), *(",".join(r) for r in corners)]) + "\n")
            text = (survey / "survey.toml").read_text()
            (survey / "survey.toml").write_text(text + '\n[[control]]\nfile = "roofs.csv"\nuse = "check"\n')
            found = common.stage_of(common.run(STAGES, survey / "survey.toml", folder / "out"), "quality.points")["findings"]
            if "planimetry" not in found:
                print(f"seed {seed}: {found.get('no_planimetry')}")
                continue
            m = found["planimetry"]
            roofs += m["roofs"]
            mean_errors.append([m["east_m"] - moved[0], m["north_m"] - moved[1]])
            sigmas.append([m["sigma_east_m"], m["sigma_north_m"]])
            single += [[r["east_m"] - moved[0], r["north_m"] - moved[1]] for r in found["roofs"]]
            single_sigma += [[np.hypot(r["sigma_east_m"], 0.01), np.hypot(r["sigma_north_m"], 0.01)] for r in found["roofs"]]
        e, s, one, of_one = map(np.array, (mean_errors, sigmas, single, single_sigma))
        rows.append([f"{100 * shift:.0f} cm", len(e), roofs, f"{100 * common.rms(e.ravel()):.1f}", f"{100 * np.abs(e).max():.1f}", f"{common.rms((e / s).ravel()):.2f}",
                     f"{100 * common.rms(one.ravel()):.1f}", f"{common.rms((one / of_one).ravel()):.2f}"])
    common.table(["shift put in", "surveys", "roofs", "error of the mean: rms per axis cm", "largest cm", "error / sigma", "of one roof: rms per axis cm", "error / sigma"], rows)


if __name__ == "__main__":
    main()
