# SPDX-License-Identifier: GPL-3.0-or-later
"""Speed of the way from a LAS cloud to classes, terrain model and contours, step by step, beside pylasr in the same run.

    speed.py [--millions 10] [--threads 2] [--rounds 3] [--filters filters.smrf ...] [--pylasr PYTHON] [--cloth 1.0]

Makes a simulated cloud (mixed scene, 8 returns per square metre, true classes in the file) in the scratch folder, or takes the one that an
earlier run with as many returns left there. Every number is a whole process; "step" is its wall time less that of reading alone, which is a run whose one stage
counts every point and does nothing else. Needs bench/accuracy's packages; --pylasr: a Python that has pylasr 0.17.4, which on Debian needs 13
(docs/performance.md); where it cannot be imported its columns stay empty. Run it on a quiet machine.
"""
import argparse
import pathlib
import resource
import subprocess
import sys
import time

import laspy
import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).parent / "accuracy"))
import common  # noqa: E402

READ = [{"type": "readers.las"}]
READ_ALL = [*READ, {"type": "filters.noise", "neighbours": 0, "low_group": 0}]  # the least that takes every point to a tile
TERRAIN = [{"type": "terrain.dtm", "cell": "1 m"}]
RETURNS_PER_METRE = 6374  # of the simulated strip's length


def make_cloud(folder, millions):
    """One LAS file with the true classes, as georeferenced; and a survey.toml that names it."""
    if (folder / "survey.toml").exists():
        return
    folder.mkdir(parents=True, exist_ok=True)
    survey = common.simulate(folder / "raw", world__length=f"{millions * 1e6 / RETURNS_PER_METRE:.0f} m", world__width="700 m", flight__lines=3, flight__overlap=0.2,
                             flight__cross_lines=0, scanner__prf="100 kHz", scanner__frequency="60 Hz", imu__file="false", gnss__file="false")
    common.run([{"type": "readers.trajectory"}, {"type": "readers.laser"}, {"type": "georeference"}, {"type": "writers.las", "compress": False}],
               survey / "survey.toml", folder / "made")
    truth = np.load(survey / "truth/returns.npy", mmap_mode="r")
    # True classes by time and return number.
    key = np.round((truth["t"] - 1e9) * 1e5).astype(np.int64) * 8 + truth["rn"]
    order = np.argsort(key)
    key, kind = key[order], truth["cls"][order].astype(np.uint8)
    tiles = sorted((folder / "made/points").glob("*.las"))
    with laspy.open(tiles[0]) as first, laspy.open(folder / "cloud.las", "w", header=first.header) as out:
        for tile in tiles:
            las = laspy.read(tile)
            mine = np.round(np.asarray(las.gps_time) * 1e5).astype(np.int64) * 8 + np.asarray(las.return_number)
            las.classification = kind[np.searchsorted(key, mine).clip(0, len(key) - 1)]
            out.write_points(las.points)
    (folder / "survey.toml").write_text('name = "cloud"\ncrs = "EPSG:32632"\n[[points]]\nfile = "cloud.las"\ncrs = "EPSG:32632"\nline = 1\n')


def timed(words, rounds, before):
    """Shortest wall time of the rounds and its CPU time, s."""
    best = None
    for _ in range(rounds):
        before()
        used, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
        done = subprocess.run([str(w) for w in words], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        wall, now = time.perf_counter() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
        if done.returncode:
            sys.exit(f"{' '.join(str(w) for w in words)}\n{done.stdout}")
        cpu = now.ru_utime + now.ru_stime - used.ru_utime - used.ru_stime
        if best is None or wall < best[0]:
            best = (wall, cpu)
    return best


def has_pylasr(python):
    """Can it be imported there? Says why not."""
    try:
        done = subprocess.run([python, "-c", "import pylasr; pylasr.reader_coverage"], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    except OSError as error:
        print(f"pylasr is left out: {error}", file=sys.stderr)
        return False
    if done.returncode:
        print(f"pylasr is left out: {python} cannot import it: {done.stdout.strip().splitlines()[-1]}", file=sys.stderr)
    return done.returncode == 0


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--millions", type=float, default=10)
    p.add_argument("--threads", type=int, default=2)
    p.add_argument("--rounds", type=int, default=3)
    p.add_argument("--filters", nargs="*", default=[])
    p.add_argument("--pylasr", help="a Python that has pylasr; left out where it has not")
    p.add_argument("--cloth", type=float, default=1.0)
    given = p.parse_args()
    if given.pylasr and not has_pylasr(given.pylasr):
        given.pylasr = None
    folder = common.SCRATCH / f"speed_{given.millions:g}"
    make_cloud(folder, given.millions)
    with laspy.open(folder / "cloud.las") as cloud:
        millions = cloud.header.point_count / 1e6
    filters = given.filters or common.ground_filters()
    best = "filters.ground" if "filters.ground" in filters else filters[0]
    writers = [{"type": "writers.las", "compress": False}, {"type": "writers.gdal"}]
    chains = {"reading alone": READ_ALL, "noise": [*READ, {"type": "filters.noise"}], **{f"ground: {name}": [*READ, {"type": name}] for name in filters},
              "TIN + DTM of true ground": [*READ, *TERRAIN], "the same, smoothing 0": [*READ, {**TERRAIN[0], "smoothing": "0 m"}],
              f"LAS to classes, DTM, contours ({best})": [*READ, {"type": "filters.noise"}, {"type": best}, *TERRAIN, {"type": "terrain.contours"}, *writers]}
    theirs = {"reading alone": "read", "noise": "noise", "TIN + DTM of true ground": "terrain", "the same, smoothing 0": "terrain", **{f"ground: {name}": "ground" for name in filters},
              f"LAS to classes, DTM, contours ({best})": "all"}
    output, rows, other = folder / "out", [], {}
    for name, chain in chains.items():
        config = folder / "chain.toml"
        config.write_text("".join("[[stage]]\n" + "".join(f"{k} = {common.toml(v)}\n" for k, v in stage.items()) + "\n" for stage in chain))
        words = [common.program(), "run", config, "--survey", folder / "survey.toml", "--output", output, "--quiet", "--set", f"run.threads={given.threads}"]
        wall, cpu = timed(words, given.rounds, lambda: subprocess.run(["rm", "-rf", output], check=True))
        reading = rows[0][1] if rows else 0.0
        if given.pylasr and theirs[name] not in other:
            other[theirs[name]] = timed([given.pylasr, pathlib.Path(__file__).parent / "pylasr_chain.py", folder / "cloud.las", folder / "pylasr.tif", given.cloth, theirs[name]], 1, lambda: None)
        rows.append((name, wall, cpu, wall - reading if rows else wall, other.get(theirs[name])))
        print(f"{name}: {wall:.2f} s", file=sys.stderr, flush=True)
    print(f"{millions:.2f} M returns, {given.threads} threads, best of {given.rounds} rounds; pylasr: one round, cloth {given.cloth:g} m\n")
    common.table(["chain", "wall s", "CPU s", "step wall s", "M returns/s of the step", "M returns/s whole", "pylasr wall s", "CPU s", "pylasr / swath wall", "CPU"],
                 [[name, f"{wall:.2f}", f"{cpu:.2f}", f"{step:.2f}", f"{millions / step:.2f}" if step > 0 else "-", f"{millions / wall:.2f}",
                   *([f"{o[0]:.2f}", f"{o[1]:.2f}", f"{o[0] / wall:.2f}", f"{o[1] / cpu:.2f}"] if o else ["-"] * 4)] for name, wall, cpu, step, o in rows])


if __name__ == "__main__":
    main()
