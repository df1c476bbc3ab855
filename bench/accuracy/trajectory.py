# SPDX-License-Identifier: GPL-3.0-or-later
"""Simulated flights of 12 minutes, IMU and GNSS records to the smoothed trajectory, against truth: trajectory.py [SEEDS [PART ...]]

Parts: grades, faults, outages."""
import concurrent.futures
import re
import shutil
import sys
import tomllib

import numpy as np

import common
import navigation

FLIGHT = {"output.laser": "false", "output.trajectory": "none", "flight.lines": 6, "flight.cross_lines": 0, "flight.line_length": "3.5 km",
          "flight.lead": "10 s", "flight.height": "1 km", "flight.overlap": 0, "flight.bank": "30 deg", "scanner.half_angle": "30 deg",
          "gnss.sigma_horizontal": "2.5 cm", "gnss.sigma_vertical": "4.5 cm"}
SECONDS = 726
IN_LINE = 416  # s after the start: 25 s into line 4
GRADES = {"navigation": {}, "tactical": {}, "mems": {"gnss.rate": "1 Hz", "gnss.outage": [(IN_LINE, 20)]}}
OUTAGES = {"20 s within a line": [(IN_LINE, 20)], "60 s within a line": [(396, 60)], "60 s in a turn": [(330, 60)],
           "first and last 20 s": [(0, 20), (SECONDS - 20, 20)]}
EXPECTED = r"no GNSS|outage|without a fix"  # warnings that tell of the outage that there is


def fly(name, seed, grade, stated=None, settings=None, **options):
    """One flight, simulated with `options` and smoothed with `settings`: what the tables take from it. Its folder is deleted."""
    folder = common.scratch(f"trajectory/{name}_{seed}")
    outages = options.pop("outages", None) or options.pop("gnss.outage", [])
    chosen = {**FLIGHT, "imu.grade": grade, "seed": seed, **options}
    if outages:
        chosen["gnss.outage"] = "[" + ", ".join(f'{{start = "{a} s", length = "{b} s"}}' for a, b in outages) + "]"
    common.call("simulate", folder / "survey", "--quiet", *common.sets(chosen))
    survey = folder / "survey/survey.toml"
    if stated:
        survey.write_text(survey.read_text().replace(f'grade = "{grade}"', f'grade = "{stated}"'))
    output = folder / "out"
    common.call("run", common.ROOT / "configs/trajectory.toml", "--survey", survey, "--output", output, "--quiet",
                *common.sets({"ins_gnss.plots": "[]", **(settings or {})}))
    described = tomllib.loads(survey.read_text())
    lines = [tuple(float(line[k].split()[0]) for k in ("start", "end")) for line in described["line"]]
    report = navigation.findings(output)
    flown, truth = navigation.sbet(output / "trajectory.sbet"), navigation.sbet(folder / "survey/truth/sbet.out")
    time, error, inside = navigation.errors(flown, truth)
    spread = navigation.sigmas(output / "trajectory.smrmsg")[inside]
    sigma = np.concatenate([spread[:, 1:4], spread[:, 7:10]], axis=1)
    start = truth[0, 0]
    spans = [(max(start + a, time[0]), min(start + a + b, time[-1])) for a, b in outages]
    line = navigation.within(time, lines)
    rms, squares = navigation.measures(error[line], sigma[line])
    found = {"rms": rms, "squares": squares, "nees": navigation.nees(output, flown, truth, lines), "nis": report["innovations"]["mean_nis"],
             "in_band": report["innovations"]["band_95"][0] <= report["innovations"]["mean_nis"] <= report["innovations"]["band_95"][1],
             "share": report["fixes"]["correlated_share"], "warnings": report["warnings"],
             "lever": np.array(report["estimates"]["lever_arm"]["value"]) - report["estimates"]["lever_arm"]["stated"],
             "outages": [outage(time, error, sigma, span) for span in spans]}
    told = report["truth"]["lines"]
    theirs = [told[a]["rms_m"] * 100 if i < 3 else told[a]["rms_arcsec"] for i, a in enumerate(navigation.AXES)]
    if not np.allclose(theirs, rms, rtol=0.02, atol=0.002):
        sys.exit(f"{name} {seed}: the report says {theirs}, the SBET {rms}")
    shutil.rmtree(folder)
    return found


def outage(time, error, sigma, span):
    """Errors within an outage, and their wander: the departure from the straight line between the errors at its two ends."""
    here = navigation.within(time, [span])
    t, e, s = time[here], error[here], sigma[here]
    part = ((t - t[0]) / (t[-1] - t[0]))[:, None]
    wander = np.linalg.norm((e - e[0] - part * (e[-1] - e[0]))[:, :3], axis=1) * 100
    return {"wander_rms": common.rms(wander), "wander_max": wander.max(), "largest": np.linalg.norm(e[:, :3], axis=1).max() * 100,
            "squares": np.mean(np.square(e / s), axis=0), "sigma": np.linalg.norm(s[:, :3], axis=1).max() * 100}


def pool(jobs):
    """Results of `fly` by name, two at a time."""
    with concurrent.futures.ThreadPoolExecutor(2) as workers:
        waiting = [(job[0], workers.submit(fly, *job[:3], **job[3])) for job in jobs]
        results = {}
        for name, future in waiting:
            results.setdefault(name, []).append(future.result())
    return results


def kind(warning):
    return re.sub(r"-?\d[\d.e+-]*", "#", warning)


def false_warnings(runs):
    return [w for r in runs for w in r["warnings"] if not (r["outages"] and re.search(EXPECTED, w))]


def warning_table(results):
    """Every kind of warning and in how many runs it stands."""
    rows = []
    for name, runs in results.items():
        kinds = {}
        for r in runs:
            for which, text in {kind(w): w for w in r["warnings"]}.items():
                kinds.setdefault(which, []).append(text)
        rows += [[name, f"{len(texts)} of {len(runs)}", texts[0]] for texts in kinds.values()]
    common.table(["case", "runs", "warning (the first of its kind)"], rows or [["all", "0", "none"]])


def error_cells(runs):
    squares = [r["squares"] for r in runs]
    return [navigation.ranges([r["rms"][:3] for r in runs]), navigation.ranges([r["rms"][3:] for r in runs], 1),
            navigation.pooled([s[:3] for s in squares]), navigation.pooled([s[3:] for s in squares])]


def grades(seeds):
    jobs = [(grade, seed, grade, options) for grade, options in GRADES.items() for seed in range(1, seeds + 1)]
    given = {"settings": {"ins_gnss.correlated_share": 0.4}}
    jobs += [("tactical, share given", seed, "tactical", given) for seed in range(1, seeds + 1)]
    results = pool(jobs)
    head = ["grade", "seeds", "rms N, E, D cm", "rms roll, pitch, heading arcsec", "error/sigma N E D", "error/sigma roll pitch heading",
            "NEES (9)", "NIS (3)", "NIS in its band", "correlated share", "false warnings"]
    rows = []
    for grade, runs in results.items():
        many = np.array([r["nees"] for r in runs])
        rows.append([grade, len(runs), *error_cells(runs), f"{many.mean():.2f}±{many.std() / np.sqrt(max(1, len(many) - 1)):.2f}",
                     navigation.ranges([[r["nis"]] for r in runs]), sum(r["in_band"] for r in runs),
                     navigation.ranges([[r["share"]] for r in runs]), len(false_warnings(runs))])
    common.table(head, rows)
    return results


def faults(seeds):
    jobs = [("mems, stated tactical", seed, "mems", {"stated": "tactical"}) for seed in range(1, seeds + 1)]
    jobs += [("tactical, stated mems", seed, "tactical", {"stated": "mems"}) for seed in range(1, seeds + 1)]
    for axis, name in enumerate(("forward", "right", "down")):
        wrong = '["' + '", "'.join("10 cm" if i == axis else "0 m" for i in range(3)) + '"]'
        jobs += [(f"lever arm 10 cm wrong {name}", seed, "tactical", {"gnss.lever_arm_error": wrong}) for seed in range(1, seeds + 1)]
    results = pool(jobs)
    rows = []
    for name, runs in results.items():
        lever = navigation.ranges([r["lever"] * 100 for r in runs], 1) if "lever" in name else ""
        rows.append([name, len(runs), sum(bool(r["warnings"]) for r in runs), *error_cells(runs), navigation.ranges([[r["nis"]] for r in runs]), lever])
    common.table(["fault", "seeds", "noticed", "rms N, E, D cm", "rms roll, pitch, heading arcsec", "error/sigma N E D", "error/sigma roll pitch heading",
                  "NIS (3)", "lever arm, estimated minus stated cm"], rows)
    return results


def outages(seeds):
    results = pool([(f"{grade}, {name}", seed, grade, {"outages": spans}) for grade in ("tactical", "mems") for name, spans in OUTAGES.items()
                    for seed in range(1, seeds + 1)])
    rows = []
    for name, runs in results.items():
        spans = [o for r in runs for o in r["outages"]]
        show = lambda key: navigation.ranges([[o[key]] for o in spans], 1)
        ratio = navigation.pooled([[np.mean(o["squares"][:3]), np.mean(o["squares"][3:])] for o in spans])
        rows.append([name, len(runs), show("wander_rms"), show("wander_max"), show("largest"), show("sigma"), ratio,
                     navigation.ranges([r["rms"][:3] for r in runs], 1), navigation.ranges([r["rms"][3:] for r in runs], 1), len(false_warnings(runs))])
    common.table(["grade, outage", "seeds", "wander rms 3D cm", "wander max cm", "largest error 3D cm", "largest sigma 3D cm",
                  "error/sigma within: position, attitude", "lines: rms N, E, D cm", "lines: rms roll, pitch, heading arcsec", "false warnings"], rows)
    return results


if __name__ == "__main__":
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 20
    parts = sys.argv[2:] or ["grades", "faults", "outages"]
    everything = {}
    for part, number in (("grades", count), ("faults", max(1, count // 4)), ("outages", max(1, count // 4))):
        if part in parts:
            everything.update({f"{part}: {name}": runs for name, runs in {"grades": grades, "faults": faults, "outages": outages}[part](number).items()})
    warning_table(everything)
