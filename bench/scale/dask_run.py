#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A survey on a Dask cluster of worker processes, some of which are killed, against one process: are the products the same bytes?

    python3 bench/scale/dask_run.py --program build/release/tools/swath --survey demo/survey.toml --workers 4 --kills 20

Needs dask and distributed. Prints wall times, bytes that tasks returned, peak memory of a task and files in the work folder. Exit code 1
where a product differs.
"""
import argparse
import hashlib
import importlib
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


def module(folder):
    """python/swath/dask.py by itself, for this process and for the workers: the package's module need not be built."""
    folder.mkdir()
    shutil.copy(ROOT / "python/swath/dask.py", folder / "swath_dask.py")
    sys.path.insert(0, str(folder))
    os.environ["PYTHONPATH"] = str(folder)
    return importlib.import_module("swath_dask")


def products(folder):
    files = {}
    for path in sorted(folder.rglob("*")):
        if path.is_file() and path.name != "report.json":
            files[str(path.relative_to(folder))] = hashlib.sha256(path.read_bytes()).hexdigest()
    return files


def processes(program, tasks):
    """Ids of the processes that do a task of this list: no others are to be killed."""
    found = []
    for entry in pathlib.Path("/proc").iterdir():
        if entry.name.isdigit():
            try:
                words = (entry / "cmdline").read_bytes().split(b"\0")
            except OSError:
                continue
            if words[:2] == [program.encode(), b"task"] and str(tasks).encode() in words:
                found.append(int(entry.name))
    return found


def parent(pid):
    return int(pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[1])


class Watch(threading.Thread):
    """Kills programs at random moments and looks at the memory of all."""

    def __init__(self, program, tasks, kills, every, seed):
        super().__init__(daemon=True)
        self.program, self.tasks, self.left, self.every, self.random = program, tasks, kills, every, random.Random(seed)
        self.killed, self.peak, self.stop = 0, 0, False

    def run(self):
        next_kill = time.monotonic() + self.random.uniform(0, 2 * self.every)
        while not self.stop:
            alive = processes(self.program, self.tasks)
            for pid in alive:
                try:
                    text = pathlib.Path(f"/proc/{pid}/status").read_text()
                    self.peak = max(self.peak, int(text.split("VmHWM:")[1].split()[0]) * 1024)
                except (OSError, IndexError):
                    pass
            if self.left and time.monotonic() > next_kill:
                if alive:
                    pid = self.random.choice(alive)
                    try:
                        # Half of the time its worker dies with it, as when a machine goes.
                        worker = parent(pid)
                        if self.random.random() < 0.5 and parent(worker) == os.getpid():
                            os.kill(worker, signal.SIGKILL)
                        os.kill(pid, signal.SIGKILL)
                        self.killed, self.left = self.killed + 1, self.left - 1
                    except OSError:
                        pass
                next_kill = time.monotonic() + self.random.uniform(0, 2 * self.every)
            time.sleep(0.02)


def main():
    a = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    a.add_argument("--program", type=pathlib.Path, required=True)
    a.add_argument("--survey", type=pathlib.Path, required=True)
    a.add_argument("--config", type=pathlib.Path, default=ROOT / "configs/survey_sbet.toml")
    a.add_argument("--set", action="append", default=[])
    a.add_argument("--workers", type=int, default=4)
    a.add_argument("--parts", type=int, default=4)
    a.add_argument("--kills", type=int, default=0)
    a.add_argument("--every", type=float, default=2.0, help="mean time between kills, s")
    a.add_argument("--seed", type=int, default=1)
    a.add_argument("--folder", type=pathlib.Path, default=pathlib.Path("out/dask"))
    given = a.parse_args()
    import dask as dask_itself
    from dask.distributed import Client, LocalCluster

    dask_itself.config.set({"distributed.scheduler.allowed-failures": 100})  # the same task may be met by several kills

    program, folder = str(given.program.resolve()), given.folder.resolve()
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    sets = [x for s in given.set for x in ("--set", s)]
    config = [str(given.config.resolve()), "--survey", str(given.survey.resolve()), *sets]
    start = time.monotonic()
    subprocess.run([program, "run", *config, "--output", str(folder / "alone"), "--threads", "2", "--quiet"], check=True)
    alone = time.monotonic() - start
    tasks = folder / "tasks.json"
    subprocess.run([program, "tasks", *config, "--output", str(folder / "shared"), "--parts", str(given.parts), "--save", str(tasks)], check=True, stdout=subprocess.DEVNULL)
    dask = module(folder / "module")
    with LocalCluster(n_workers=given.workers, threads_per_worker=1, processes=True, dashboard_address=None, local_directory=str(folder / "workers")) as cluster, Client(cluster) as client:
        cluster.adapt(minimum=given.workers, maximum=given.workers, interval="500ms")  # as a job system gives new workers for lost ones
        watch = Watch(program, tasks, given.kills, given.every, given.seed)
        watch.start()
        start = time.monotonic()
        figures = dask.run(tasks, client, program, retries=10)
        shared = time.monotonic() - start
        watch.stop = True
        watch.join()
    same = products(folder / "alone") == products(folder / "shared")
    print(json.dumps({
        "tasks": len(figures), "workers": given.workers, "killed": watch.killed, "same_products": same,
        "alone_two_threads_s": round(alone, 1), "shared_s": round(shared, 1), "in_tasks_s": round(sum(f["seconds"] for f in figures), 1),
        "bytes_returned": sum(len(json.dumps(f)) for f in figures), "peak_memory_of_a_task_MB": round(watch.peak / 1e6),
        "bytes_of_the_list": tasks.stat().st_size}, indent=2))
    return 0 if same else 1


if __name__ == "__main__":
    sys.exit(main())
