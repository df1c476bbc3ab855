#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A survey on a Dask cluster of worker processes, some of which are killed, against one process: are the products the same bytes?

    python3 bench/scale/dask_run.py --program build/release/tools/swath --survey demo/survey.toml --workers 4 --kills 20

Needs dask and distributed. Prints wall times, bytes that tasks returned, peak memory of a task and files in the work folder. Exit code 1
where a product differs.
"""
import argparse
import hashlib
import importlib.util
import json
import os
import pathlib
import random
import shutil
import signal
import subprocess
import sys
import threading
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]


def module():
    spec = importlib.util.spec_from_file_location("swath_dask", ROOT / "python/swath/dask.py")
    made = importlib.util.module_from_spec(spec)
    sys.modules["swath_dask"] = made
    spec.loader.exec_module(made)
    return made


def products(folder):
    files = {}
    for path in sorted(folder.rglob("*")):
        if path.is_file() and path.name != "report.json":
            files[str(path.relative_to(folder))] = hashlib.sha256(path.read_bytes()).hexdigest()
    return files


def processes(word):
    """Process ids whose command line holds the word."""
    found = []
    for entry in pathlib.Path("/proc").iterdir():
        if entry.name.isdigit():
            try:
                if word in (entry / "cmdline").read_bytes().replace(b"\0", b" "):
                    found.append(int(entry.name))
            except OSError:
                pass
    return found


class Watch(threading.Thread):
    """Kills programs at random moments and looks at the memory of all."""

    def __init__(self, word, kills, seed):
        super().__init__(daemon=True)
        self.word, self.left, self.random = word, kills, random.Random(seed)
        self.killed, self.peak, self.stop = 0, 0, False

    def run(self):
        next_kill = time.monotonic() + self.random.uniform(0.5, 3)
        while not self.stop:
            for pid in processes(self.word):
                try:
                    text = pathlib.Path(f"/proc/{pid}/status").read_text()
                    self.peak = max(self.peak, int(text.split("VmHWM:")[1].split()[0]) * 1024)
                except (OSError, IndexError):
                    pass
            if self.left and time.monotonic() > next_kill:
                alive = processes(self.word)
                if alive:
                    pid = self.random.choice(alive)
                    try:
                        # Half of the time its worker dies with it, as when a machine goes.
                        if self.random.random() < 0.5:
                            os.kill(int(pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[1]), signal.SIGKILL)
                        os.kill(pid, signal.SIGKILL)
                        self.killed, self.left = self.killed + 1, self.left - 1
                    except OSError:
                        pass
                next_kill = time.monotonic() + self.random.uniform(0.3, 3)
            time.sleep(0.05)


def main():
    a = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    a.add_argument("--program", type=pathlib.Path, required=True)
    a.add_argument("--survey", type=pathlib.Path, required=True)
    a.add_argument("--config", type=pathlib.Path, default=ROOT / "configs/survey_sbet.toml")
    a.add_argument("--set", action="append", default=[])
    a.add_argument("--workers", type=int, default=4)
    a.add_argument("--parts", type=int, default=4)
    a.add_argument("--kills", type=int, default=0)
    a.add_argument("--seed", type=int, default=1)
    a.add_argument("--folder", type=pathlib.Path, default=pathlib.Path("out/dask"))
    given = a.parse_args()
    from dask.distributed import Client, LocalCluster

    program, folder = str(given.program.resolve()), given.folder.resolve()
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    sets = [x for s in given.set for x in ("--set", s)]
    config = [str(given.config.resolve()), "--survey", str(given.survey.resolve()), *sets]
    start = time.monotonic()
    subprocess.run([program, "run", *config, "--output", str(folder / "alone"), "--threads", "2", "--quiet"], check=True)
    alone = time.monotonic() - start
    plan = folder / "tasks.json"
    subprocess.run([program, "plan", *config, "--output", str(folder / "shared"), "--parts", str(given.parts), "--tasks", str(plan), "--quiet"], check=True)
    dask = module()
    import cloudpickle

    cloudpickle.register_pickle_by_value(dask)  # the workers need not have the module
    with LocalCluster(n_workers=given.workers, threads_per_worker=1, processes=True, dashboard_address=None, local_directory=str(folder / "workers")) as cluster, Client(cluster) as client:
        watch = Watch(b" task ", given.kills, given.seed)
        watch.start()
        start = time.monotonic()
        figures = dask.run(plan, client, program, retries=10)
        shared = time.monotonic() - start
        watch.stop = True
        watch.join()
    same = products(folder / "alone") == products(folder / "shared")
    print(json.dumps({
        "tasks": len(figures), "workers": given.workers, "killed": watch.killed, "same_products": same,
        "alone_two_threads_s": round(alone, 1), "shared_s": round(shared, 1), "in_tasks_s": round(sum(f["seconds"] for f in figures), 1),
        "bytes_returned": sum(len(json.dumps(f)) for f in figures), "peak_memory_of_a_task_MB": round(watch.peak / 1e6),
        "plan_bytes": plan.stat().st_size}, indent=2))
    return 0 if same else 1


if __name__ == "__main__":
    sys.exit(main())
