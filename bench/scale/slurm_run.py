#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A survey by job arrays of a Slurm of its own on this machine, against one process: are the products the same bytes?

    python3 bench/scale/slurm_run.py --program build/release/tools/swath --survey demo/survey.toml --parts 4 --kills 5

Needs slurmctld, slurmd and sbatch (Debian: slurm-wlm), a munged that runs, and root. Exit code 1 where a product differs.
"""
import argparse
import json
import os
import pathlib
import random
import shutil
import signal
import socket
import subprocess
import sys
import time

from dask_run import ROOT, processes, products

CONF = """ClusterName=swath
SlurmctldHost={host}(127.0.0.1)
AuthType=auth/munge
SlurmUser=root
SlurmdUser=root
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
SlurmctldPort=16817
SlurmdPort=16818
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core_Memory
ReturnToService=2
MpiDefault=none
SwitchType=switch/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
MailProg=/bin/true
NodeName={host} NodeAddr=127.0.0.1 CPUs={cpus} RealMemory={memory} State=UNKNOWN
PartitionName=main Nodes={host} Default=YES MaxTime=INFINITE State=UP
"""


class Slurm:
    def __init__(self, folder):
        for name in ("state", "spool"):
            (folder / name).mkdir(parents=True)
        memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") // 2**20
        self.conf = folder / "slurm.conf"
        self.conf.write_text(CONF.format(host=socket.gethostname(), folder=folder, cpus=os.cpu_count(), memory=int(0.9 * memory)))
        os.environ["SLURM_CONF"] = str(self.conf)
        self.daemons = [subprocess.Popen([name, "-D", "-f", str(self.conf)], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
                        for name in ("slurmctld", "slurmd")]
        for _ in range(60):
            if "idle" in subprocess.run(["sinfo", "-h", "-o", "%T"], capture_output=True, text=True).stdout:
                return
            time.sleep(0.5)
        raise SystemExit(f"Slurm does not start: see {folder}/slurmctld.log")

    def stop(self):
        for daemon in self.daemons:
            daemon.terminate()
            daemon.wait()

    def waiting(self):
        return subprocess.run(["squeue", "-h", "-o", "%i %T"], capture_output=True, text=True).stdout.split("\n")[:-1]


def main():
    a = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    a.add_argument("--program", type=pathlib.Path, required=True)
    a.add_argument("--survey", type=pathlib.Path, required=True)
    a.add_argument("--config", type=pathlib.Path, default=ROOT / "configs/survey_sbet.toml")
    a.add_argument("--set", action="append", default=[])
    a.add_argument("--parts", type=int, default=4)
    a.add_argument("--kills", type=int, default=0, help="tasks to kill (kill -9); the script is then given again, as a user does")
    a.add_argument("--folder", type=pathlib.Path, default=pathlib.Path("out/slurm"))
    given = a.parse_args()
    program, folder = str(given.program.resolve()), given.folder.resolve()
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    config = [str(given.config.resolve()), "--survey", str(given.survey.resolve()), *(x for s in given.set for x in ("--set", s))]
    subprocess.run([program, "run", *config, "--output", str(folder / "alone"), "--quiet"], check=True)
    tasks, jobs = folder / "tasks.json", folder / "jobs.sh"
    subprocess.run([program, "tasks", *config, "--output", str(folder / "shared"), "--parts", str(given.parts), "--save", str(tasks),
                    "--slurm", str(jobs)], check=True, stdout=subprocess.DEVNULL)
    slurm = Slurm(folder / "slurm")
    chance, killed, given_times, start = random.Random(3), 0, 0, time.monotonic()
    try:
        while not (folder / "shared/report.json").exists():
            if given_times > given.kills + 1:
                raise SystemExit("the jobs do not end: see slurm-*.out in " + str(folder))
            subprocess.run(["sh", str(jobs)], check=True, cwd=folder, stdout=subprocess.DEVNULL)
            given_times += 1
            due = time.monotonic() + chance.uniform(0.5, 4)
            while slurm.waiting():
                if killed < given.kills and time.monotonic() > due and (alive := processes(program, tasks)):
                    os.kill(chance.choice(alive), signal.SIGKILL)
                    killed, due = killed + 1, time.monotonic() + chance.uniform(0.5, 4)
                time.sleep(0.1)
    finally:
        slurm.stop()
    same = products(folder / "alone") == products(folder / "shared")
    print(json.dumps({"tasks": len(json.loads(tasks.read_text())["tasks"]), "killed": killed, "script_given": given_times,
                      "shared_s": round(time.monotonic() - start, 1), "same_products": same}, indent=2))
    return 0 if same else 1


if __name__ == "__main__":
    sys.exit(main())
