#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Peak of memory against run.memory, and of the work folder against the input: raw survey, clouds from LAS and LAZ, LAZ bombs.

    bench/memory.py                                 10 M returns, budgets of 200 MB, 500 MB and 2 GB
    bench/memory.py --returns 40 --cases cloud-las  40 M returns, one case
    bench/memory.py --keep --trace ...              keeps the inputs in SWATH_SCRATCH; peak by stage

A run passes where its peak is within 10 % of run.memory, or where it has less than 2 GB and is refused with exit code 2 and the budget that
works; the bomb may be refused with any. Where the system lets it, each run has a memory cgroup of its own, limited to 110 % of its budget, in
which a run that takes more is killed; the peak is VmHWM of the process, which counts code and mapped files besides. Needs numpy and
laspy[lazrs] for the bomb alone.
"""
import argparse
import json
import os
import pathlib
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
SWATH = pathlib.Path(os.environ.get("SWATH_PROGRAM") or ROOT / "build/release/tools/swath")
UNITS = {"MB": 1e6, "GB": 1e9}
CASES = {  # config, input
    "raw": ("survey_sbet", "raw"),
    "cloud-las": ("cloud", "las"),
    "cloud-laz": ("cloud", "laz"),
    "classes-las": ("classes", "las"),
    "classes-laz": ("classes", "laz"),
    "terrain-las": ("terrain", "las"),
    "terrain-laz": ("terrain", "laz"),
    "bomb": ("cloud", "bomb"),
}
TOLERANCE = 1.1
LARGEST_WORK = 2.0
ENOUGH = 2e9  # bytes: the default budget, with which no case may be refused


def bytes_of(text):
    number, unit = text.split()
    return float(number) * UNITS[unit]


def simulate(folder, returns):
    """About `returns` million, three lines, 9 per square metre."""
    if not (folder / "survey.toml").exists():
        sets = {"world.length": f"{160 * returns} m", "world.width": "700 m", "flight.lines": 3, "flight.overlap": 0.2,
                "flight.cross_lines": 0, "scanner.prf": "100 kHz", "scanner.frequency": "60 Hz", "output.formats": '["las"]',
                "imu.file": "false", "gnss.file": "false"}
        subprocess.run([SWATH, "simulate", folder, "--quiet"] + [f"--set={k}={v}" for k, v in sets.items()], check=True)
        shutil.rmtree(folder / "truth")
        survey = folder / "survey.toml"
        survey.write_text(survey.read_text().split("[truth]")[0])


def config_of(name, scratch):
    """The project's own config, without the comparison with truth."""
    text = (ROOT / "configs" / f"{name}.toml").read_text()
    file = scratch / f"{name}.toml"
    file.write_text(text.replace('[[stage]]\ntype = "report.truth"', ""))
    return file


def make_clouds(raw, scratch, returns):
    """The survey's points with their classes, as LAS and as LAZ."""
    for kind in ("las", "laz"):
        folder = scratch / f"{kind}_{returns}"
        if (folder / "survey.toml").exists():
            continue
        subprocess.run([SWATH, "run", config_of("survey_sbet", scratch), "--survey", raw / "survey.toml", "--output", folder / "made",
                        "--quiet", f"--set=las.compress={'true' if kind == 'laz' else 'false'}"], check=True)
        files = sorted((folder / "made/points").glob(f"*.{kind}"))
        for f in files:
            f.rename(folder / f.name)
        shutil.rmtree(folder / "made")
        (folder / "survey.toml").write_text(
            'name = "cloud"\ncrs = "EPSG:32632"\n' + "".join(f'\n[[points]]\nfile = "{f.name}"\n' for f in files))


def make_bomb(folder):
    """48 million returns at one place and time in some kilobytes."""
    if (folder / "survey.toml").exists():
        return
    import laspy
    import numpy as np
    folder.mkdir(parents=True)
    header = laspy.LasHeader(point_format=6, version="1.4")
    header.scales, header.offsets = [0.001] * 3, [500000.0, 5000000.0, 0.0]
    with laspy.open(folder / "bomb.laz", "w", header=header) as out:
        points = laspy.ScaleAwarePointRecord.zeros(1_000_000, header=header)
        points.x, points.y, points.z = np.full(len(points), 500100.0), np.full(len(points), 5000100.0), np.full(len(points), 100.0)
        points.return_number[:] = points.number_of_returns[:] = 1
        for _ in range(48):
            out.write_points(points)
    (folder / "survey.toml").write_text('name = "bomb"\ncrs = "EPSG:32632"\n\n[[points]]\nfile = "bomb.laz"\ncrs = "EPSG:32632"\n')


def size_of(folder):
    total = 0
    for path, _, files in os.walk(folder):
        for f in files:
            try:
                total += os.lstat(os.path.join(path, f)).st_size
            except OSError:  # gone meanwhile
                pass
    return total


def make_cgroup(limit):
    """A memory cgroup within the one of this process, v1 or v2; None where the system does not let it."""
    for line in pathlib.Path("/proc/self/cgroup").read_text().splitlines():
        _, kinds, path = line.split(":", 2)
        if kinds not in ("memory", ""):
            continue
        top = pathlib.Path("/sys/fs/cgroup/memory" if kinds else "/sys/fs/cgroup")
        group = pathlib.Path(f"{top}{path}") / f"swath_memory_{os.getpid()}"
        try:
            group.mkdir()
        except OSError:
            continue
        try:
            (group / ("memory.limit_in_bytes" if kinds else "memory.max")).write_text(str(int(limit)))
            return group
        except OSError:
            group.rmdir()
    return None


def peak_of(pid):
    try:
        found = re.search(r"VmHWM:\s+(\d+)", pathlib.Path(f"/proc/{pid}/status").read_text())
        return int(found[1]) * 1024 if found else 0
    except OSError:
        return 0


def run(config, survey, budget, threads, trace, sets=()):
    out = pathlib.Path(tempfile.mkdtemp(prefix="memory_", dir=survey.parent.parent))
    group = make_cgroup(TOLERANCE * bytes_of(budget))
    log = out / "log"

    def enter():
        if group:
            (group / "cgroup.procs").write_text(str(os.getpid()))

    command = [SWATH, "run", config, "--survey", survey, "--output", out / "products", "--json-log", f"--set=run.memory={budget}",
               f"--threads={threads}", *(f"--set={s}" for s in sets)]
    begun = time.monotonic()
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    with open(log, "w") as err:
        process = subprocess.Popen(command, stderr=err, stdout=err, preexec_fn=enter)
        peak = work = 0
        stages = []
        next_size = 0.0
        try:
            while process.poll() is None:
                peak = max(peak, peak_of(process.pid))
                if time.monotonic() > next_size:
                    work = max(work, size_of(out / "products/.swath"))
                    next_size = time.monotonic() + 0.1
                if trace:
                    lines = [l for l in log.read_text().splitlines() if l.startswith("{")]
                    what = json.loads(lines[-1]).get("stage", "?") if lines else "start"
                    if not stages or stages[-1][0] != what:
                        stages.append([what, 0])
                    stages[-1][1] = max(stages[-1][1], rss_of(process.pid))
                time.sleep(0.02)
        finally:
            process.kill()
            process.wait()
    text = log.read_text()
    seconds = time.monotonic() - begun
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    if group:
        group.rmdir()
    shutil.rmtree(out)
    return {"exit": process.returncode, "peak": peak, "work": work, "seconds": seconds, "cpu": cpu, "cgroup": group is not None,
            "stages": stages, "error": text[text.find("swath: error"):].strip() if "swath: error" in text else ""}


def rss_of(pid):
    try:
        return int(pathlib.Path(f"/proc/{pid}/statm").read_text().split()[1]) * 4096
    except (OSError, IndexError):
        return 0


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--returns", type=int, default=10, help="million")
    p.add_argument("--budgets", nargs="+", default=["200 MB", "500 MB", "2 GB"])
    p.add_argument("--cases", nargs="+", default=list(CASES), choices=list(CASES))
    p.add_argument("--threads", type=int, default=2)
    p.add_argument("--set", nargs="*", default=[], help="options of every run")
    p.add_argument("--trace", action="store_true", help="peak by stage")
    p.add_argument("--keep", action="store_true", help="keep what was made as input")
    a = p.parse_args()
    scratch = pathlib.Path(os.environ.get("SWATH_SCRATCH") or tempfile.mkdtemp(prefix="swath_memory_")).resolve()
    scratch.mkdir(parents=True, exist_ok=True)
    kinds = {CASES[c][1] for c in a.cases}
    raw = scratch / f"raw_{a.returns}"
    if kinds != {"bomb"}:
        simulate(raw, a.returns)
    if kinds & {"las", "laz"}:
        make_clouds(raw, scratch, a.returns)
    if "bomb" in kinds:
        make_bomb(scratch / "bomb")
    failed = 0
    for case in a.cases:
        name, kind = CASES[case]
        folder = raw if kind == "raw" else scratch / ("bomb" if kind == "bomb" else f"{kind}_{a.returns}")
        size = size_of(folder)
        for budget in a.budgets:
            r = run(config_of(name, scratch), folder / "survey.toml", budget, a.threads, a.trace, a.set)
            refused = r["exit"] == 2 and "run.memory" in r["error"]
            held = r["peak"] <= TOLERANCE * bytes_of(budget)
            small = kind == "bomb" or refused or r["work"] <= LARGEST_WORK * size
            allowed = refused and (bytes_of(budget) < ENOUGH or kind == "bomb")
            good = held and small and (allowed or r["exit"] in (0, 3))
            failed += not good
            print(f"{case:12} {budget:>7}  peak {r['peak'] / 1e6:7.0f} MB = {r['peak'] / bytes_of(budget):5.2f}  exit {r['exit']:3}"
                  f"{' refused' if refused else '':8}  work folder / input {r['work'] / size:8.2f}  {r['seconds']:6.1f} s, CPU {r['cpu']:6.1f} s  "
                  f"{'pass' if good else 'FAIL'}", flush=True)
            if r["error"]:
                print("    " + r["error"].replace("\n", "\n    "))
            for what, most in r["stages"]:
                print(f"    {what:24} {most / 1e6:7.0f} MB")
    print(("each run in a cgroup limited to 110 % of its budget" if r["cgroup"] else "without a cgroup: sampled alone") +
          f"; {failed} failed")
    if not a.keep and not os.environ.get("SWATH_SCRATCH"):
        shutil.rmtree(scratch)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
