# SPDX-License-Identifier: GPL-3.0-or-later
"""The joint adjustment of simulated MEMS surveys against truth: network.py [SEEDS [PART ...]]

Four lines and one across over halls, fixes of 1 Hz. Parts: held (the calibration is known), boresight (it is off by its stated sigmas, roll, pitch and heading
are estimated), outage (as held, no fixes for 60 s over line 3). Errors within the lines, those of the smoother beside those of the network."""
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
          "flight.height": "500 m", "scanner.prf": "20 kHz", "scanner.frequency": "30 Hz", "mounting.deliver": "truth", "output.truth_returns": "false",
          "imu.grade": "mems", "gnss.rate": "1 Hz", "output.trajectory": "none"}
BORESIGHT = {"mounting.deliver": "nominal", "mounting.random_boresight": "0.02 deg"}
STATED = 'roll = "0.02 deg"\npitch = "0.02 deg"\nheading = "0.02 deg"\n'
PARTS = {"held": ({}, {}), "boresight": (BORESIGHT, {"estimate.roll": True, "estimate.pitch": True, "estimate.heading": True}), "outage": ({}, {})}
OUTAGE = ("line 3", 25.0, 60.0)  # begins so many seconds before that line, and lasts so long
COMPONENTS = ("north", "east", "down", "roll", "pitch", "heading")
VALUES = ("boresight_roll", "boresight_pitch", "boresight_heading")


def with_outage(folder, options):
    common.call("simulate", folder / "plan", "--quiet", *common.sets({**options, "output.laser": "false"}))
    plan = tomllib.loads((folder / "plan/survey.toml").read_text())
    start = next(float(l["start"].split()[0]) for l in plan["line"] if l["name"] == OUTAGE[0])
    begin = navigation.sbet(folder / "plan/truth/sbet.out")[0, 0]
    return {**options, "gnss.outage": f'[{{start = "{start - begin - OUTAGE[1]:.3f} s", length = "{OUTAGE[2]} s"}}]'}


def fly(part, seed):
    folder = common.scratch(f"network/{part}_{seed}")
    more, how = PARTS[part]
    options = {**SURVEY, **more, "seed": seed}
    if part == "outage":
        options = with_outage(folder, options)
    survey = folder / "survey"
    common.call("simulate", survey, "--quiet", *common.sets(options))
    config = folder / "network.toml"
    stages = [{"type": t} for t in ("readers.imu", "readers.gnss", "readers.laser")] + [{"type": "calib.network", **how}]
    config.write_text("".join("[[stage]]\n" + "".join(f"{k} = {common.toml(v)}\n" for k, v in s.items()) + "\n" for s in stages))
    sigmas = {"sigma.roll": "0.02 deg", "sigma.pitch": "0.02 deg", "sigma.heading": "0.02 deg"} if part == "boresight" else {}
    if sigmas:
        text = (survey / "survey.toml").read_text()
        head, _, tail = text.partition("[sigma]\n")
        lines = [l for l in tail.splitlines() if l.split(" ")[0] not in ("roll", "pitch", "heading")]
        (survey / "survey.toml").write_text(head + "[sigma]\n" + STATED + "\n".join(lines) + "\n")
    common.call("run", config, "--survey", survey / "survey.toml", "--output", folder / "out", "--quiet")
    found = json.loads((folder / "out/network.json").read_text())
    truth = json.loads((survey / "truth/calibration.json").read_text())
    if not os.environ.get("KEEP"):
        shutil.rmtree(folder)
    return found, truth


def figures(done, which):
    """RMS over seeds of each component's rms error and of its error over sigma."""
    of = [[d["truth"][which]["lines"][c] for c in COMPONENTS] for d, _ in done]
    errors = np.array([[c.get("rms_m", c.get("rms_arcsec")) for c in one] for one in of])
    pulls = np.array([[c.get("error_over_sigma", np.nan) for c in one] for one in of])
    return np.sqrt(np.mean(errors**2, axis=0)), np.sqrt(np.mean(pulls**2, axis=0))


def main():
    seeds = int(sys.argv[1]) if len(sys.argv) > 1 else 5
    rows, values = [], []
    for part in sys.argv[2:] or PARTS:
        with concurrent.futures.ThreadPoolExecutor(int(os.environ.get("WORKERS", "2"))) as pool:
            done = list(pool.map(lambda seed: fly(part, seed), range(1, seeds + 1)))
        for which in ("smoother", "network"):
            error, pull = figures(done, which)
            rows.append([part, seeds, which, " ".join(f"{100 * v:.1f}" for v in error[:3]), f"{100 * np.sqrt(np.sum(error[:3]**2)):.1f}",
                         " ".join(f"{v:.1f}" for v in error[3:]), " ".join(f"{v:.2f}" for v in pull)])
        for d, truth in done:
            for name in VALUES:
                if name in d.get("values", {}):
                    v = d["values"][name]
                    values.append((v["value"] - np.radians(truth[name.split("_")[1]])) / v["sigma"])
        print(f"- {part}: planes {[d['planes'] for d, _ in done]}, settled {[d['settled'] for d, _ in done]}, "
              f"rms on planes cm {[(round(100 * d['rms_before_m'], 2), round(100 * d['rms_after_m'], 2)) for d, _ in done]}")
    common.table(["survey", "seeds", "trajectory", "rms N E D cm", "3D cm", "roll pitch heading arcsec", "error/sigma N E D roll pitch heading"], rows)
    if values:
        print(f"boresight, error/sigma over {len(values)} values: {np.sqrt(np.mean(np.square(values))):.2f}")


if __name__ == "__main__":
    main()
