# SPDX-License-Identifier: GPL-3.0-or-later
"""What a run makes of a damaged work folder, of kills, of an output folder that is removed, of many starts in one folder and of full disks:
the products must be the same bytes, or the run refused.

  python3 bench/damage.py --program build/release/tools/swath         240 damages, 100 kills, 30 removals, 120 starts, 33 disk sizes
  python3 bench/damage.py --program ... --damages 1000 --seed 2

A damage flips a bit, cuts a file short, empties it, fills it with zeros, deletes it, swaps it with another, or deletes a folder. Disks are
small tmpfs mounts and need the right to mount; without it they are left out, and the program says so.
"""
import argparse
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

SOURCE = Path(__file__).resolve().parent.parent
SURVEY = ["imu.file=false", "gnss.file=false", "world.scene=hills", "world.length=160 m", "world.width=120 m", "flight.lines=2",
          "flight.cross_lines=0", "flight.height=250 m", "scanner.prf=3 kHz", "mounting.deliver=truth"]
FULL_SURVEY = ["world.scene=hills", "world.length=200 m", "world.width=120 m", "flight.lines=2", "flight.cross_lines=1",
               "flight.height=250 m", "scanner.prf=3 kHz", "mounting.deliver=truth"]


def sets(options):
    return [word for option in options for word in ("--set", option)]


def products(folder):
    return {str(p.relative_to(folder)): p.read_bytes() for p in sorted(Path(folder).rglob("*"))
            if p.is_file() and p.name != "report.json" and ".swath" not in p.relative_to(folder).parts}


class Bench:
    def __init__(self, arguments):
        self.program = Path(arguments.program).resolve()
        self.random = random.Random(arguments.seed)
        self.folder = Path(tempfile.mkdtemp(prefix="swath-damage-"))
        self.survey = self.folder / "survey"
        self.config = SOURCE / "configs" / ("survey.toml" if arguments.full else "survey_sbet.toml")
        self.tile = "run.tile=100 m"
        subprocess.run([self.program, "simulate", self.survey, "--quiet", *sets(FULL_SURVEY if arguments.full else SURVEY)], check=True)

    def command(self, out, *options):
        return [self.program, "run", self.config, "--survey", self.survey / "survey.toml", "--output", out, "--quiet",
                *sets([self.tile, *options])]

    def run(self, out, *options):
        return subprocess.run(self.command(out, *options), capture_output=True, text=True, timeout=600)

    # --- damages

    def damage(self, work):
        """Damages one file or folder; returns the kind and its name."""
        files = sorted(p for p in work.rglob("*") if p.is_file())
        kind = self.random.choice(("flip", "flip", "cut", "empty", "zeros", "delete", "swap", "folder", "longer"))
        one = self.random.choice(files)
        if kind == "folder":
            one = self.random.choice(sorted(p for p in work.rglob("*") if p.is_dir()))
            shutil.rmtree(one)
            return kind, one.relative_to(work)
        size = one.stat().st_size
        if kind == "flip" and size > 0:
            data = bytearray(one.read_bytes())
            data[self.random.randrange(size)] ^= 1 << self.random.randrange(8)
            one.write_bytes(data)
        elif kind == "cut":
            os.truncate(one, self.random.randrange(max(1, size)))
        elif kind == "empty":
            os.truncate(one, 0)
        elif kind == "zeros":
            one.write_bytes(bytes(size))
        elif kind == "longer":
            with open(one, "ab") as f:
                f.write(self.random.randbytes(self.random.randrange(1, 100)))
        elif kind == "delete":
            one.unlink()
        elif kind == "swap":
            other = self.random.choice(files)
            if other != one:
                spare = one.with_name("spare")
                one.rename(spare)
                other.rename(one)
                spare.rename(other)
        return kind, one.relative_to(work)

    def damages(self, count):
        reference = self.folder / "reference"
        done = self.run(reference, "run.keep_work=true")
        assert done.returncode == 0, done.stderr
        expected = products(reference)
        outcomes, faults = Counter(), []
        for number in range(count):
            out = self.folder / "trial"
            shutil.rmtree(out, ignore_errors=True)
            out.mkdir()
            shutil.copytree(reference / ".swath", out / ".swath", symlinks=True)
            made = [self.damage(out / ".swath") for _ in range(self.random.choice((1, 1, 1, 2, 5)))]
            done = self.run(out, "run.keep_work=true")
            what = f"damage {number}: " + ", ".join(f"{kind} {name}" for kind, name in made)
            if done.returncode == 0:
                report = json.loads((out / "report.json").read_text())
                if products(out) != expected:
                    faults.append(f"{what}: other products")
                outcomes["remade" if report["pieces_damaged"] else "made again or without effect"] += 1
            elif done.returncode in (1, 2) and done.stderr.count("error:") == 1 and "terminate" not in done.stderr:
                outcomes["refused"] += 1
            else:
                faults.append(f"{what}: exit {done.returncode} {done.stderr[:300]}")
        self.say(f"{count} damages", outcomes, faults)
        return faults

    # --- kills

    def kills(self, count):
        whole = self.folder / "whole"
        start = time.monotonic()
        done = self.run(whole)
        takes = time.monotonic() - start
        assert done.returncode == 0, done.stderr
        expected = products(whole)
        outcomes, faults, killed = Counter(), [], 0
        out = self.folder / "killed"
        while killed < count:
            run = subprocess.Popen(self.command(out), stderr=subprocess.PIPE)
            try:
                run.wait(timeout=self.random.uniform(0.02, takes))
            except subprocess.TimeoutExpired:
                run.send_signal(signal.SIGKILL)
                run.wait()
                killed += 1
                if killed < count:
                    continue
                run = subprocess.run(self.command(out), capture_output=True, text=True)
            if run.returncode != 0:
                faults.append(f"after {killed} kills: exit {run.returncode}")
            elif products(out) != expected or [p for p in out.rglob(".*")]:
                faults.append(f"after {killed} kills: other products, or stray files")
            else:
                outcomes["finished with the same bytes"] += 1
            shutil.rmtree(out, ignore_errors=True)
        self.say(f"{count} kills", outcomes, faults)
        return faults

    # --- removals

    def removals(self, count):
        """The output folder is removed at a random moment; neither the run, unless it was just ending, nor the next one may end with exit 0
        and fewer products."""
        expected = products(self.folder / "whole")
        start = time.monotonic()
        out = self.folder / "removed"
        self.run(out)
        takes = time.monotonic() - start
        outcomes, faults = Counter(), []
        for number in range(count):
            shutil.rmtree(out, ignore_errors=True)
            run = subprocess.Popen(self.command(out), stderr=subprocess.PIPE, text=True)
            time.sleep(self.random.uniform(0.02, takes))
            ended_before = run.poll() is not None
            removed = time.monotonic()
            shutil.rmtree(out, ignore_errors=True)
            _, error = run.communicate()
            if ended_before:
                outcomes["ended before"] += 1
                continue
            if run.returncode == 0 and products(out) != expected and time.monotonic() - removed > 0.2:
                faults.append(f"removal {number}: exit 0 without the products, {time.monotonic() - removed:.3f} s after it")
            elif run.returncode not in (0, 1, 2) or (run.returncode and error.count("error:") != 1):
                faults.append(f"removal {number}: exit {run.returncode} {error[:300]}")
            else:
                outcomes["begun anew" if run.returncode == 0 else "seen"] += 1
            done = self.run(out)
            if done.returncode != 0 or products(out) != expected:
                faults.append(f"removal {number}: the next run: exit {done.returncode}, or other products {done.stderr[:300]}")
        self.say(f"{count} removals", outcomes, faults)
        return faults

    # --- starts

    def starts(self, count, at_once=6):
        """Several starts of one command at almost the same time: one works, the others are refused or find the products made."""
        expected = products(self.folder / "whole")
        outcomes, faults = Counter(), []
        out = self.folder / "shared"
        for first in range(0, count, at_once):
            shutil.rmtree(out, ignore_errors=True)
            runs = []
            for _ in range(min(at_once, count - first)):
                runs.append(subprocess.Popen(self.command(out), stderr=subprocess.PIPE, text=True))
                time.sleep(self.random.choice((0, 0, 0.01, 0.1, 0.5)))
            for run in runs:
                _, error = run.communicate()
                if run.returncode == 0:
                    outcomes["done"] += 1
                elif run.returncode == 2 and error.count("error:") == 1 and "another run is at work" in error:
                    outcomes["refused"] += 1
                else:
                    faults.append(f"start {first}: exit {run.returncode} {error[:300]}")
            if products(out) != expected or [p for p in out.rglob(".*")]:
                faults.append(f"start {first}: other products, or stray files")
        self.say(f"{count} starts, {at_once} at once", outcomes, faults)
        return faults

    # --- disks

    def disks(self, count):
        if os.geteuid() != 0:
            print("disks: left out, only root may mount them")
            return []
        expected = products(self.folder / "whole")
        mount = self.folder / "disk"
        mount.mkdir()
        outcomes, faults = Counter(), []
        for number in range(count):
            kilobytes = int(64 * (12000 / 64) ** (number / max(1, count - 1)))
            mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={kilobytes}k", "tmpfs", mount], capture_output=True)
            if mounted.returncode != 0:
                print("disks: left out, mounting is not allowed here")
                return faults
            try:
                out = mount / "out"
                done = self.run(out)
                if done.returncode != 0:
                    kept = (out / ".swath").exists()
                    stray = [p for p in out.rglob(".part*")]
                    good = done.returncode == 1 and done.stderr.count("error:") == 1 and "disk is full" in done.stderr
                    if not good or not kept or stray:
                        faults.append(f"{kilobytes} kB: exit {done.returncode}, work kept: {kept}, stray: {len(stray)}: {done.stderr[:300]}")
                    subprocess.run(["mount", "-o", "remount,size=300m", mount], check=True)
                    done = self.run(out)
                    resumed = json.loads((out / "report.json").read_text())["pieces_resumed"] if done.returncode == 0 else 0
                    outcomes["full, then finished" + (" from kept pieces" if resumed else "")] += 1
                else:
                    outcomes["large enough"] += 1
                if done.returncode != 0 or products(out) != expected:
                    faults.append(f"{kilobytes} kB: exit {done.returncode} with space, or other products")
            finally:
                subprocess.run(["umount", mount], check=True)
        self.say(f"{count} disk sizes", outcomes, faults)
        return faults

    @staticmethod
    def say(what, outcomes, faults):
        print(f"{what}: " + ", ".join(f"{n} {outcome}" for outcome, n in sorted(outcomes.items())) + f"; {len(faults)} faults", flush=True)
        for fault in faults:
            print("  " + fault, flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", required=True)
    parser.add_argument("--damages", type=int, default=240)
    parser.add_argument("--kills", type=int, default=100)
    parser.add_argument("--removals", type=int, default=30)
    parser.add_argument("--starts", type=int, default=120)
    parser.add_argument("--disks", type=int, default=33)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--full", action="store_true", help="from IMU and GNSS, with configs/survey.toml")
    arguments = parser.parse_args()
    bench = Bench(arguments)
    try:
        faults = bench.damages(arguments.damages)
        faults += bench.kills(arguments.kills)
        faults += bench.removals(arguments.removals)
        faults += bench.starts(arguments.starts)
        faults += bench.disks(arguments.disks)
    finally:
        shutil.rmtree(bench.folder, ignore_errors=True)
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
