# SPDX-License-Identifier: GPL-3.0-or-later
"""A run by several processes: the products of one, whoever is killed; what is out of turn or of another run is refused."""
import json
import os
import random
import shutil
import signal
import subprocess
import time
import unittest

from support import CONFIG, SMALL, SOURCE, SWATH, Case, products, sets, swath

TILES = sets(["run.tile=100 m"])


class Tasks(Case):
    simulated = SMALL

    def request(self, survey=None, out=None):
        return [CONFIG, "--survey", (survey or self.survey) / "survey.toml", "--output", out or self.out, *TILES]

    def listed(self, *more, **named):
        file = self.folder / "tasks.json"
        done = swath("tasks", *self.request(**named), "--save", file, *more)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        return file, json.loads(file.read_text())["tasks"]

    def task(self, file, task, code=0):
        done = swath("task", task, "--tasks", file, "--quiet")
        self.assertEqual(done.returncode, code, done.stderr)
        return done

    def alone(self):
        self.run_ok(self.survey / "survey.toml", *TILES, out=self.folder / "alone")
        return products(self.folder / "alone")

    def assert_products(self, expected):
        found = products(self.out)
        self.assertEqual(found.keys(), expected.keys())
        self.assertEqual([name for name in expected if found[name] != expected[name]], [])

    def test_waves_and_parts_give_the_products_of_one_run(self):
        expected = self.alone()
        _, tasks = self.listed("--parts", "3")
        for task in tasks:
            done = swath("run", *self.request(), "--wave", task["wave"], "--part", f"{task['part']}/{task['parts']}", "--quiet")
            self.assertEqual((done.returncode, done.stderr), (0, ""), task["id"])
        self.assert_products(expected)
        # Offsets of flight lines are what ground and its terrain follow from: a comparison that finds none would show nothing.
        self.assertGreater(max(abs(line["offset_m"]) for line in json.loads(expected["lines.json"])["lines"]), 0.0)

    def test_processes_killed_at_random_moments_change_nothing(self):
        expected = self.alone()
        file, tasks = self.listed("--parts", "3")
        moments = random.Random(7)
        command = lambda task: [SWATH, "task", task["id"], "--tasks", file, "--quiet"]
        killed = 0
        start = time.monotonic()
        subprocess.run(command(tasks[0]), check=True)
        takes = time.monotonic() - start
        for wave in range(1, tasks[-1]["wave"] + 1):
            mine = [t for t in tasks if t["wave"] == wave]
            # All parts at once, some twice, and every one of them killed.
            running = [subprocess.Popen(command(t), stderr=subprocess.DEVNULL) for t in mine + mine[:1]]
            for one in running:
                try:
                    one.wait(timeout=moments.uniform(0.0, takes))
                except subprocess.TimeoutExpired:
                    one.send_signal(signal.SIGKILL)
                    killed += 1
                one.wait()
            if wave < tasks[-1]["wave"]:  # the last removes the work folder
                for t in mine:
                    self.task(file, t["id"])
            elif not (self.out / "report.json").exists() or list(self.out.glob(".swath*")):
                self.task(file, mine[0]["id"])
        self.assertGreater(killed, 3)
        self.assertFalse((self.out / ".swath").exists())
        self.assert_products(expected)

    def test_what_is_out_of_turn_is_refused_and_the_run_goes_on(self):
        expected = self.alone()
        survey = self.copy()
        file, tasks = self.listed("--parts", "2", survey=survey)
        self.assert_error(swath("task", "1-strips.1", "--tasks", file, "--quiet"), 2, "there is no work folder", "do wave 0 first")
        self.task(file, "0-survey")
        self.task(file, "1-strips.1")
        self.assert_error(swath("task", "2-filters.noise.1", "--tasks", file, "--quiet"), 2, "is missing", "wave 1 .strips. first")
        other = swath("run", *self.request(survey), "--set", "run.tile=90 m", "--wave", "0", "--quiet")
        self.assert_error(other, 2, "it holds work of another plan")
        self.assert_error(swath("task", "1-strip.1", "--tasks", file, "--quiet"), 2, "did you mean '1-strips.1'")
        self.assert_error(swath("task", "1-strips.2", "--tasks", CONFIG, "--quiet"), 2, "it is a pipeline, not a list of tasks")
        self.assert_error(swath("task", "1-strips.2", "--tasks", file, "--threads", "2000"), 2, "'2000' is not a number of threads", "1024")
        record = next(survey.glob("laser.*"))
        kept = record.stat()
        os.utime(record, (kept.st_atime, kept.st_mtime + 2))
        self.assert_error(swath("task", "1-strips.2", "--tasks", file, "--quiet"), 2, "it has changed since the tasks were listed", record.name)
        os.utime(record, ns=(kept.st_atime_ns, kept.st_mtime_ns))
        shutil.move(self.out, self.folder / "elsewhere")  # a disk that is not mounted on this machine
        self.assert_error(swath("task", "1-strips.2", "--tasks", file, "--quiet"), 2, "there is no work folder", "does this machine see the folder")
        self.assertFalse(self.out.exists())
        shutil.move(self.folder / "elsewhere", self.out)
        for t in tasks[2:]:
            self.task(file, t["id"])
        self.assert_products(expected)

    def test_the_files_of_a_plan_and_of_a_run_are_told_apart(self):
        self.assert_error(swath("plan", CONFIG, "--output", self.out), 2, "it is a pipeline, not a flight plan", "`swath tasks`")
        self.assert_error(swath("tasks", SOURCE / "configs/flight/plan.toml"), 2, "it is a flight plan, not a pipeline", "`swath plan`")
        self.assert_error(swath("tasks", *self.request(), "--slurm", self.folder / "jobs.sh"), 2, "--save")
        self.assert_error(swath("run", *self.request(), "--wave", "99", "--quiet"), 2, "there is no wave 99")
        self.assert_error(swath("run", *self.request(), "--wave", "1", "--part", "3/2", "--quiet"), 2, "'3/2' is not a part")
        self.assert_error(swath("tasks", CONFIG), 2, "no survey")
        self.assertEqual(list(self.folder.iterdir()), [])


if __name__ == "__main__":
    unittest.main()
