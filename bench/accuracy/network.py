# SPDX-License-Identifier: GPL-3.0-or-later
"""The joint adjustment of simulated MEMS surveys against truth: network.py [SEEDS [PART ...]]

SEEDS: their number, or first-last. Four lines and one across over halls, fixes of 1 Hz. Parts: held (the calibration is known), boresight (it
is off by up to 0.02 deg, its sigma stated; roll, pitch and heading are estimated), outage60, outage120, outage300 (as held, no fixes for so many seconds about
line 3), drift (as held, 90 % of the fixes' variance correlated over 120 s, sigmas of 6 and 10 cm), lever (as held, the antenna's lever arm known to
2 mm and not to 2 cm), town (as held, over houses at 4 returns/m^2 of each line), town_lever (both). Errors within the lines, those of the smoother
beside those of the network, and how they split into what all lines have in common, lines differ by, and wanders within them; points georeferenced with
the adjusted trajectory, against true returns."""
import concurrent.futures
import json
import os
import shutil
import sys
import tomllib

import numpy as np

import common
import navigation

SURVEY = {"world.scene": "airfield", "world.length": "700 m", "world.width": "500 m", "flight.lines": 4, "flight.cross_lines": 1, "flight.overlap": 0.5,
          "flight.height": "500 m", "scanner.prf": "10 kHz", "scanner.frequency": "30 Hz", "mounting.deliver": "truth", "imu.grade": "mems",
          "gnss.rate": "1 Hz", "output.trajectory": "none"}
# All but the boresight as on the drawing board.
BORESIGHT = {"mounting.deliver": "nominal", "mounting.truth.roll": "0 deg", "mounting.truth.pitch": "0 deg", "mounting.truth.heading": "0 deg",
             "mounting.truth.range_offset": "0 m", "mounting.truth.scan_scale": 1, "mounting.random_boresight": "0.02 deg",
             "mounting.sigma.lever_arm": "0 m", "mounting.nominal_sigma.lever_arm": "0 m"}
DRIFT = {"gnss.sigma_horizontal": "6 cm", "gnss.sigma_vertical": "10 cm", "gnss.correlated_share": 0.9}
TOWN = {"world.scene": "town", "scanner.prf": "80 kHz", "scanner.frequency": "80 Hz"}
ADJUSTMENT = {"planes.planes": 1200, "sections": 0}  # planes for accuracy, not for density: the default takes all
LEVER, MEASURED_LEVER = 0.02, 0.002  # m: sigma of each component of the antenna's lever arm, stated and true
ANGLES = ("roll", "pitch", "heading")
PARTS = {"held": {}, "boresight": BORESIGHT, "outage60": {}, "outage120": {}, "outage300": {}, "drift": DRIFT, "lever": {}, "town": TOWN, "town_lever": TOWN}
OUTAGE_LINE = "line 3"  # in the middle of the outage
COMPONENTS = ("north", "east", "down", "roll", "pitch", "heading")


def with_outage(folder, options, seconds):
    common.call("simulate", folder / "plan", "--quiet", *common.sets({**options, "output.laser": "false"}))
    plan = tomllib.loads((folder / "plan/survey.toml").read_text())
    line = next(l for l in plan["line"] if l["name"] == OUTAGE_LINE)
    middle = np.mean([float(line[k].split()[0]) for k in ("start", "end")])
    begin = navigation.sbet(folder / "plan/truth/sbet.out")[0, 0]
    return {**options, "gnss.outage": f'[{{start = "{max(10.0, middle - begin - seconds / 2):.3f} s", length = "{seconds} s"}}]'}


def errors_of_points(output, survey):
    """3D rms of the returns without outliers, m, and the mean squares of their error over sigma across and of height."""
    truth, points = np.load(survey / "truth/returns.npy"), common.points_of(output)
    order = common.paired(points, truth["t"] - 1e9, truth["rn"])
    good = ~np.isin(truth["cls"], common.OUTLIERS)
    error = common.errors_of(points, order, truth)[good]
    h, v = points["sigma_h"][order][good], points["sigma_v"][order][good]
    return {"rms": np.sqrt(np.mean(np.sum(error**2, axis=1))),
            "squares": [np.mean(np.sum(error[:, :2] ** 2, axis=1) / h**2), np.mean((error[:, 2] / v) ** 2)]}


def errors_by_line(output, survey):
    """Errors of the adjusted trajectory on each line: n x 6 each."""
    lines = tomllib.loads((survey / "survey.toml").read_text())["line"]
    flown, truth = navigation.sbet(output / "trajectory.sbet"), navigation.sbet(survey / "truth/sbet.out")
    time, error, _ = navigation.errors(flown, truth)
    return [error[navigation.within(time, [tuple(float(l[k].split()[0]) for k in ("start", "end"))])] for l in lines]


def relative(errors):
    """Rms of the lines' mean position errors about the mean of all lines, m: 3D."""
    means = np.array([e[:, :3].mean(axis=0) for e in errors])
    return np.sqrt(np.mean(np.sum((means - means.mean(axis=0)) ** 2, axis=1)))


def split(errors):
    """Attitude's mean over all lines, rms of the lines' means about it, rms about the lines' means: roll, pitch, heading each, rad."""
    means = np.array([e[:, 3:].mean(axis=0) for e in errors])
    within = np.sqrt(np.mean([np.mean((e[:, 3:] - m) ** 2, axis=0) for e, m in zip(errors, means)], axis=0))
    return [means.mean(axis=0).tolist(), means.std(axis=0).tolist(), within.tolist()]


def fly(part, seed):
    folder = common.scratch(f"network/{part}_{seed}")
    lever = MEASURED_LEVER if part.endswith("lever") else LEVER
    off = lever * np.random.default_rng(seed).normal(size=3)
    options = {**SURVEY, **PARTS[part], "seed": seed, "gnss.lever_arm_error": json.dumps([f"{v:.4f} m" for v in off]), "gnss.lever_arm_sigma": f"{lever} m"}
    if part.startswith("outage"):
        options = with_outage(folder, options, float(part.removeprefix("outage")))
    if part == "boresight":
        options["output.truth_returns"] = "false"
    survey, output = folder / "survey", folder / "out"
    common.call("simulate", survey, "--quiet", *common.sets(options))
    how = {}
    if part == "boresight":
        how = {f"estimate.{a}": True for a in ANGLES}
    stages = [{"type": t} for t in ("readers.imu", "readers.gnss", "readers.laser")] + [{"type": "calib.network", **ADJUSTMENT, **how}, {"type": "writers.trajectory"}]
    if part != "boresight":
        stages += [{"type": "georeference"}, {"type": "filters.returns"}, {"type": "writers.las", "compress": False}]
    common.run(stages, survey / "survey.toml", output)
    found = json.loads((output / "network.json").read_text())
    errors = errors_by_line(output, survey)
    found["relative"], found["split"] = relative(errors), split(errors)
    if part != "boresight":
        found["points"] = errors_of_points(output, survey)
    truth = json.loads((survey / "truth/calibration.json").read_text())
    found["pulls"] = [(found["values"][f"boresight_{a}"]["value"] - np.radians(float(truth[a].split()[0]))) / found["values"][f"boresight_{a}"]["sigma"]
                      for a in ANGLES if found.get("values")]
    if not os.environ.get("KEEP"):
        shutil.rmtree(folder)
    kept = common.SCRATCH / "network/results"
    kept.mkdir(parents=True, exist_ok=True)
    (kept / f"{part}_{seed}.json").write_text(json.dumps(found))
    return found


def figures(done, which):
    """RMS over seeds of each component's rms error and of its error over sigma."""
    of = [[d["truth"][which]["lines"][c] for c in COMPONENTS] for d in done]
    errors = np.array([[c.get("rms_m", c.get("rms_arcsec")) for c in one] for one in of])
    pulls = np.array([[c.get("error_over_sigma", np.nan) for c in one] for one in of])
    return errors, pulls


def report(part, done, rows):
    for which in ("smoother", "network"):
        errors, pulls = figures(done, which)
        rms, worst = common.rms(errors), np.sqrt(np.sum(errors[:, :3] ** 2, axis=1)).max()
        rows.append([part, len(done), which, " ".join(f"{100 * v:.1f}" for v in rms[:3]), f"{100 * np.sqrt(np.sum(rms[:3]**2)):.1f}", f"{100 * worst:.1f}",
                     " ".join(f"{v:.1f}" for v in rms[3:]), navigation.pooled(pulls**2)])
    rms = lambda values: f"{100 * np.sqrt(np.mean(np.square(values))):.2f}"
    print(f"- {part}: planes {min(d['planes'] for d in done)} to {max(d['planes'] for d in done)}, settled {sum(d['settled'] for d in done)} of {len(done)}, "
          f"lines apart on planes {rms([d['rms_before_m'] for d in done])} and {rms([d['rms_after_m'] for d in done])} cm, "
          f"lines' position relative to one another {rms([d['relative'] for d in done])} cm, "
          f"sigma of surfaces {np.mean([d['surface_sigma_m'] for d in done]) * 1000:.1f} mm, groups displaced {sum(d['groups_displaced'] for d in done)}")
    shares = common.rms(np.array([d["split"] for d in done])) / navigation.ARCSEC
    print("  roll, pitch, heading, arcsec: " + ", ".join(f"{name} {' '.join(f'{v:.1f}' for v in row)}" for name, row in zip(("all lines alike", "between lines", "within lines"), shares)))
    kinds = sorted({k for d in done for k in d["components"]})
    print("  factors of sigmas: " + ", ".join(f"{k} {np.mean([v for v in (d['components'].get(k, {}).get('factor') for d in done) if v is not None] or [np.nan]):.2f}" for k in kinds))
    if "points" in done[0]:
        of = [d["points"] for d in done]
        print(f"  points: 3D rms {rms([p['rms'] for p in of])} cm, worst seed {100 * max(p['rms'] for p in of):.2f} cm, error/sigma across and of height "
              f"{navigation.pooled([p['squares'] for p in of])}")
    pulls = np.array([d["pulls"] for d in done])
    if pulls.size:
        print(f"  boresight roll, pitch, heading, error/sigma: {navigation.pooled(pulls**2)}")
    sys.stdout.flush()


def main():
    first, _, last = (sys.argv[1] if len(sys.argv) > 1 else "5").rpartition("-")
    seeds = range(int(first or 1), int(last) + 1)
    rows = []
    for part in sys.argv[2:] or PARTS:
        with concurrent.futures.ThreadPoolExecutor(int(os.environ.get("WORKERS", "2"))) as pool:
            done = list(pool.map(lambda seed: fly(part, seed), seeds))
        report(part, done, rows)
    common.table(["survey", "seeds", "trajectory", "rms N E D cm", "3D cm", "worst seed", "roll pitch heading arcsec", "error/sigma N E D roll pitch heading"], rows)


if __name__ == "__main__":
    main()
