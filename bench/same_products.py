#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Every config of configs/ on the simulated demo survey with two programs: are the products the same?

    bench/same_products.py OLD NEW                       two programs
    bench/same_products.py --record FOLDER PROGRAM       surveys, products and hashes of one program, to compare with later
    bench/same_products.py FOLDER NEW                    what was recorded, and a program
    bench/same_products.py OLD NEW --configs survey cloud --renamed table.txt

One line per config, exit 1 where a product differs. LAS, LAZ, GeoTIFF, GeoPackage, SBET and smrmsg: the same bytes. JSON (calibration values and
report.json among them), GeoJSON, CSV, DXF and VRT: the same features and values. PNG, SVG, PDF and HTML are drawn: counts and sizes only. --masks lists what is
left out of the comparison and why; the head of bench/product_contents.py's class Renamed says what the table of --renamed holds.

Each program makes its surveys itself (compared as the line "simulate") and takes the configs of the tree it was built in, or else this
tree's; the first lines say which. --full: the demo survey of scripts/demo.sh as it is, and all planes; without it fewer pulses, about 2 minutes for a
program. Clouds are the points of survey.toml's run.
Python alone, no packages.
"""
import argparse
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time

sys.dont_write_bytecode = True  # this tree and those of the programs stay as they are
import product_contents as contents  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parent.parent
DEMO = {"events.file": "true"}
SMALL_DEMO = {"scanner.prf": "8 kHz"}
CALIBRATION = {"flight.pattern": "calibration", "world.length": "360 m", "world.width": "360 m", "flight.line_length": "420 m", "flight.height": "350 m",
               "flight.second_height": "0 m", "flight.profile_lines": "false", "scanner.prf": "15 kHz", "output.trajectory": "none",
               "output.truth_returns": "false", "control.roof": "true"}
SMALL = {"calibrate": {"adjust.planes.planes": "300", "adjust.jackknife.blocks": "5"},
         "strips": {"strips.planes.planes": "300"}}
CLOUDS = ("cloud", "classes", "terrain")
SHOWN = 5  # differences of a config that are listed


def in_order(names):
    """survey.toml first: the clouds come from it."""
    return sorted(names, key=lambda n: (n != "survey", n))


class Failed(Exception):
    pass


def sets(options):
    return [f"--set={k}={v}" for k, v in options.items()]


def call(program, folder, *words):
    done = subprocess.run([program, *map(str, words)], cwd=folder, capture_output=True, text=True)
    if done.returncode not in (0, 3):
        raise Failed(f"swath {' '.join(map(str, words))}: exit {done.returncode}\n{done.stdout}{done.stderr}")


def configs_of(program):
    """The configs of the tree that a program was built in (TREE/build/PRESET/tools/swath), or this tree's."""
    own = program.parents[3] / "configs" if len(program.parents) > 3 else None
    return own if own and own.is_dir() else ROOT / "configs"


def make_hangar(folder):
    """The hangar survey of the tests of the command line."""
    sys.path.insert(0, str(ROOT / "tests/cli"))
    for name, value in (("SWATH_PROGRAM", "swath"), ("SWATH_RASTER_VALUES", "none"), ("SWATH_SOURCE", str(ROOT))):
        os.environ.setdefault(name, value)
    import lever_arm_test
    folder.mkdir()
    lever_arm_test.make_hangar(folder)


def make_surveys(program, folder, full, names):
    call(program, folder, "simulate", "surveys/demo", "--quiet", *sets({**DEMO, **({} if full else SMALL_DEMO)}))
    if "calibrate" in names:
        call(program, folder, "simulate", "surveys/calibration", "--quiet", *sets(CALIBRATION))
    if "lever_arm" in names:
        make_hangar(folder / "surveys/hangar")


def make_cloud(program, folder):
    """A cloud of its own from the products of survey.toml, which is run for it where it was not asked for."""
    cloud = folder / "surveys/cloud"
    if cloud.exists():
        return
    points = folder / "products/survey/points"
    if not points.exists():
        call(program, folder, "run", "configs/survey.toml", "--survey", "surveys/demo/survey.toml", "--output", "for_cloud", "--quiet")
        points = folder / "for_cloud/points"
    cloud.mkdir()
    files = sorted(points.glob("*.la[sz]"))
    for f in files:
        shutil.copy(f, cloud / f.name)
    (cloud / "survey.toml").write_text('name = "cloud"\ncrs = "EPSG:32632"\n' + "".join(f'\n[[points]]\nfile = "{f.name}"\n' for f in files))


def run_config(program, folder, name, full, more):
    """One config, where both programs have the same relative paths: they stand in the report."""
    kind = "calibration" if name == "calibrate" else "hangar" if name == "lever_arm" else "cloud" if name in CLOUDS else "demo"
    if kind == "cloud":
        make_cloud(program, folder)
    options = {**({} if full else SMALL.get(name, {})), **more.get(name, {}), **more.get("*", {})}
    call(program, folder, "run", f"configs/{name}.toml", "--survey", f"surveys/{kind}/survey.toml", "--output", f"products/{name}", "--quiet",
         *sets(options))
    shutil.rmtree(folder / "products" / name / ".swath", ignore_errors=True)


def files_of(folder):
    return {f.relative_to(folder).as_posix(): f for f in sorted(folder.rglob("*")) if f.is_file()}


class Side:
    """A program at work in a folder of its own, or what was recorded of one."""

    def __init__(self, path, folder, options, more):
        self.path, self.full, self.more = path, options.full, more
        self.recorded = path.is_dir()
        self.folder = path if self.recorded else folder
        if self.recorded:
            record = json.loads((path / "hashes.json").read_text())
            self.hashes, self.full = record["hashes"], record["full"]
            self.configs = record.get("configs", "the record")
            self.names = in_order(n for n in self.hashes if n != "simulate")
            if options.full != self.full:
                sys.exit(f"{path} was recorded {'with' if self.full else 'without'} --full")
        else:
            self.configs = str(configs_of(path))
            shutil.copytree(self.configs, self.folder / "configs")
            self.hashes = {}
            self.names = in_order(f.stem for f in (self.folder / "configs").glob("*.toml"))

    def products(self, name):
        return self.folder / ("surveys" if name == "simulate" else f"products/{name}")

    def make(self, name, names):
        if self.recorded:
            return
        if name == "simulate":
            make_surveys(self.path, self.folder, self.full, names)
        else:
            run_config(self.path, self.folder, name, self.full, self.more)
        self.hashes[name] = {k: {"kind": contents.kind_of(k), "bytes": f.stat().st_size, "sha256": contents.digest(f)}
                             for k, f in files_of(self.products(name)).items()}


def compare(name, old, new, renamed, options):
    """Differences of one config, as lines, and how many files of each kind were compared."""
    a, b = old.hashes[name], new.hashes[name]
    if name == "simulate":  # clouds are made from products and compared there
        kept = {k.split("/")[0] for k in a} & {k.split("/")[0] for k in b} if options.configs else {"demo", "calibration", "hangar"}
        a, b = ({k: v for k, v in side.items() if k.split("/")[0] in kept} for side in (a, b))
    out, count, drawn = [], {}, [0, 0, 0, 0]
    for file in sorted({*a, *b}):
        kind = contents.kind_of(file)
        count[kind] = count.get(kind, 0) + 1
        if kind == "drawn":
            for k, side in enumerate((a, b)):
                drawn[k] += file in side
                drawn[k + 2] += side.get(file, {"bytes": 0})["bytes"]
        elif file not in a or file not in b:
            out.append(f"{file}: {'new' if file in b else 'missing in the new'}")
        elif a[file]["sha256"] != b[file]["sha256"]:
            if kind == "bytes":
                out.append(f"{file}: other bytes ({a[file]['bytes']} and {b[file]['bytes']})")
            else:
                out += [f"{file}: {line}" for line in contents.compare(file, old.products(name) / file, new.products(name) / file, renamed,
                                                                       options.sentences_may_differ)]
    text = ", ".join(f"{n} {'by bytes' if k == 'bytes' else k}" for k, n in sorted(count.items()) if k != "drawn")
    if drawn[0] or drawn[1]:
        text += f"; drawn: {drawn[0]} files of {drawn[2] // 1000} kB, now {drawn[1]} of {drawn[3] // 1000} kB"
    return out, text


def options_of(words):
    """CONFIG:stage.option=value -> {CONFIG: {option: value}}; without CONFIG for every config."""
    out = {}
    for word in words:
        key, _, value = word.partition("=")
        config, _, option = key.rpartition(":")
        out.setdefault(config or "*", {})[option] = value
    return out


def parse():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0], epilog="\n".join(__doc__.splitlines()[1:]),
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("old", nargs="?", type=pathlib.Path, help="a program, or a folder of --record")
    parser.add_argument("new", nargs="?", type=pathlib.Path, help="a program")
    parser.add_argument("--record", type=pathlib.Path, metavar="FOLDER", help="runs one program and keeps its products and hashes in this new folder")
    parser.add_argument("--configs", nargs="+", metavar="NAME", help="these alone")
    parser.add_argument("--renamed", type=pathlib.Path, metavar="TABLE", help="keys that have another name now")
    parser.add_argument("--sentences-may-differ", action="store_true", help="texts of three or more words are not compared")
    parser.add_argument("--set-old", nargs="+", default=[], metavar="CONFIG:STAGE.OPTION=VALUE", help="an option for the old program alone")
    parser.add_argument("--set-new", nargs="+", default=[], metavar="CONFIG:STAGE.OPTION=VALUE", help="an option for the new program alone")
    parser.add_argument("--full", action="store_true", help="the demo survey in full")
    parser.add_argument("--masks", action="store_true", help="lists what is not compared, and why")
    return parser.parse_args()


def record(options):
    if options.record.exists():
        sys.exit(f"{options.record} exists")
    options.record.mkdir(parents=True)
    side = Side((options.old or options.new).resolve(), options.record, options, options_of(options.set_old))
    names = in_order(options.configs or side.names)
    print(f"{side.path}: configs of {side.configs}", flush=True)
    for name in ["simulate", *names]:
        began = time.monotonic()
        side.make(name, names)
        print(f"{name:20} {len(side.hashes[name])} files, {time.monotonic() - began:.1f} s", flush=True)
    (options.record / "hashes.json").write_text(json.dumps({"full": options.full, "configs": side.configs, "hashes": side.hashes}, indent=1) + "\n")


def main():
    options = parse()
    if options.masks:
        for what, why in contents.MASKED.items():
            print(f"{what}: {why}")
        return 0
    if options.record:
        record(options)
        return 0
    if not options.old or not options.new:
        sys.exit("two programs, or a recorded folder and a program")
    renamed = contents.Renamed(options.renamed)
    different = 0
    with tempfile.TemporaryDirectory(prefix="same_products_", dir=os.environ.get("SWATH_SCRATCH")) as scratch:
        folders = [pathlib.Path(scratch) / side for side in ("old", "new")]
        for f in folders:
            f.mkdir()
        old = Side(options.old.resolve(), folders[0], options, options_of(options.set_old))
        new = Side(options.new.resolve(), folders[1], options, options_of(options.set_new))
        for word, side in (("old", old), ("new", new)):
            print(f"{word}: {side.path}, configs of {side.configs}", flush=True)
        names = in_order(options.configs or {*old.names, *new.names})
        for name in ["simulate", *names]:
            lacking = [word for side, word in ((old, "old"), (new, "new")) if name != "simulate" and name not in side.names]
            if lacking:
                print(f"{name:20} DIFFERENT: the {lacking[0]} has no such config", flush=True)
                different += 1
                continue
            for side in (old, new):
                side.make(name, names)
            found, text = compare(name, old, new, renamed, options)
            different += bool(found)
            print(f"{name:20} {'DIFFERENT' if found else 'same'}: {text}", flush=True)
            for line in found[:SHOWN]:
                print(f"    {line}")
            if len(found) > SHOWN:
                print(f"    ... and {len(found) - SHOWN} more")
    for rule in renamed.unused() if not options.configs else []:
        print(f"--renamed: nothing is called so: {rule}")
    return 1 if different else 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except Failed as e:
        sys.exit(str(e))
