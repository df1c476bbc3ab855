# SPDX-License-Identifier: GPL-3.0-or-later
"""The work folder after damage, inputs that products would overwrite, folders that are not ours, names that are taken."""
import json
import os
import shutil
import signal
import subprocess
import time
import unittest

from support import CONFIG, FULL, SMALL, SMALLEST, SWATH, Case, cloud_survey, products, sets, substitute, swath

TRAJECTORY = '[[stage]]\ntype = "readers.trajectory"\n\n[[stage]]\ntype = "writers.trajectory"\n'
CLOUD = '[[stage]]\ntype = "readers.las"\n\n[[stage]]\ntype = "writers.las"\ncompress = false\n'


class Damage(Case):
    simulated = SMALL

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.reference = cls.class_folder / "reference"
        done = subprocess.run(cls.command(cls.reference), capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        cls.expected = {name: data for name, data in products(cls.reference).items() if not name.startswith(".swath")}

    @classmethod
    def command(cls, out):
        return [SWATH, "run", CONFIG, "--survey", cls.survey / "survey.toml", "--output", out, "--quiet",
                *sets(["run.tile=100 m", "run.keep_work=true"])]

    def check(self, damage, pattern):
        """The same command on a work folder of which one file that fits the pattern is damaged."""
        out = self.folder / "out"
        shutil.rmtree(out, ignore_errors=True)
        out.mkdir()
        shutil.copytree(self.reference / ".swath", out / ".swath")
        one = max(out.glob(".swath/" + pattern), key=lambda p: (p.stat().st_size, p.name))
        damage(one)
        done = subprocess.run(self.command(out), capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stderr), (0, ""), pattern)
        found = {name: data for name, data in products(out).items() if not name.startswith(".swath")}
        self.assertEqual(found.keys(), self.expected.keys(), pattern)
        self.assertEqual([name for name in found if found[name] != self.expected[name]], [], pattern)
        return json.loads((out / "report.json").read_text())

    def test_a_damaged_piece_is_made_again_and_the_report_says_so(self):
        def flip(file):
            data = bytearray(file.read_bytes())
            data[len(data) // 2] ^= 0x10
            file.write_bytes(data)

        kinds = {"*/strip_*/*.pts": flip, "*filters.ground*/*.cols": lambda f: os.truncate(f, 0), "*/*.grid": flip,
                 "*writers.las*/products/points/*.laz": flip, "*writers.gdal*/products/dtm/*.tif": lambda f: os.truncate(f, 100),
                 "*/strip_0001/strip.json": flip, "*filters.noise*/*_*.done": lambda f: os.truncate(f, 7),
                 "*terrain.contours*/*.segments": lambda f: f.write_bytes(bytes(f.stat().st_size)),
                 "*filters.hag*/*.cols": lambda f: f.unlink()}
        kinds = {pattern: damage for pattern, damage in kinds.items() if list(self.reference.glob(".swath/" + pattern))}
        self.assertGreaterEqual(len(kinds), 8)
        for pattern, damage in kinds.items():
            with self.subTest(pattern=pattern):
                report = self.check(damage, pattern)
                self.assertEqual(report["pieces_damaged"], 1, pattern)
                self.assertGreater(report["pieces_resumed"], 0, pattern)

    def test_what_is_missing_altogether_is_made_again(self):
        for pattern in ("*/strip_0002", "*terrain.dtm*", "*writers.las*/products"):
            with self.subTest(pattern=pattern):
                self.check(shutil.rmtree, pattern)

    def test_files_that_belong_to_no_piece_are_not_delivered(self):
        self.check(lambda f: shutil.copy(f, f.with_name("stale.laz")), "*writers.las*/products/points/*.laz")

    def test_an_undamaged_folder_is_used_whole(self):
        report = self.check(lambda f: None, "*/*.done")
        self.assertEqual(report["pieces_damaged"], 0)


class Overwrite(Case):
    simulated = SMALLEST

    def refused(self, config, survey, out, *words):
        before = {p: p.read_bytes() for p in survey.parent.rglob("*") if p.is_file()}
        done = swath("run", config, "--survey", survey, "--output", out, "--quiet")
        self.assert_error(done, 2, *words, "hint: ")
        for file, data in before.items():
            self.assertEqual(file.read_bytes() == data, True, f"{file} was changed")
        self.assertEqual(list(out.rglob(".swath")) if out.exists() else [], [], "work was begun")
        self.assert_error(swath("check", config, "--survey", survey, "--output", out), 2, *words)

    def config(self, text):
        file = self.folder / "config.toml"
        file.write_text(text)
        return file

    def test_the_surveys_own_trajectory(self):
        folder = self.copy()
        (folder / "sbet.out").rename(folder / "trajectory.sbet")
        substitute(folder / "survey.toml", "sbet.out", "trajectory.sbet")
        (self.folder / "link").symlink_to(folder)
        self.refused(self.config(TRAJECTORY), folder / "survey.toml", folder, "trajectory.sbet", "overwrite a file that it reads")
        self.refused(self.config(TRAJECTORY), folder / "survey.toml", self.folder / "link", "trajectory.sbet")

    def test_a_file_that_the_survey_names_and_the_run_does_not_read(self):
        survey = cloud_survey(self.folder / "survey", [(500000.0 + i, 5300100.0, 100.0) for i in range(10)])
        other = survey.parent / "points.csv"
        other.write_text("x,y,z\n")
        with survey.open("a") as toml:
            toml.write('\n[[control]]\nfile = "points/control.csv"\n')
        (survey.parent / "points").mkdir()
        (survey.parent / "points" / "control.csv").write_text("id,x,y,z\n1,500000,5300000,100\n")
        self.refused(self.config(CLOUD), survey, survey.parent, "points/control.csv", "folder of its own product")

    def test_an_input_cloud_in_the_folder_of_the_products(self):
        survey = cloud_survey(self.folder / "survey", [(500000.0 + i, 5300100.0, 100.0) for i in range(10)])
        (survey.parent / "points").mkdir()
        (survey.parent / "cloud.las").rename(survey.parent / "points" / "cloud.las")
        substitute(survey, '"cloud.las"', '"points/cloud.las"')
        self.refused(self.config(CLOUD), survey, survey.parent, "points/cloud.las")
        # The same cloud, reached by a link of either kind.
        out = self.folder / "soft"
        out.mkdir()
        (out / "points").symlink_to(survey.parent / "points")
        self.refused(self.config(CLOUD), survey, out, "points/cloud.las")
        out = self.folder / "hard"
        (out / "points").mkdir(parents=True)
        os.link(survey.parent / "points" / "cloud.las", out / "points" / "500000_5300000.las")
        self.refused(self.config(CLOUD), survey, out, "points/cloud.las", "overwrite a file that it reads")

    def test_the_report_over_the_config(self):
        survey = cloud_survey(self.folder / "survey", [(500000.0 + i, 5300100.0, 100.0) for i in range(10)])
        config = self.folder / "report.json"
        config.write_text('{"stage": [{"type": "readers.las"}, {"type": "writers.las"}]}')
        self.refused(config, survey, self.folder, "report.json")


class Names(Case):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.survey = cloud_survey(cls.class_folder / "survey", [(500000.0 + i, 5300100.0, 100.0) for i in range(10)])
        cls.config = cls.class_folder / "config.toml"
        cls.config.write_text(CLOUD)

    def run_it(self, out=None, *options):
        return swath("run", self.config, "--survey", self.survey, "--output", out or self.out, "--quiet", *options)

    def test_a_work_folder_that_is_not_ours_stays(self):
        mine = self.folder / "mine"
        mine.mkdir()
        (mine / "notes.txt").write_text("mine")
        self.out.mkdir()
        for name in (".swath", ".swath-discarded"):
            with self.subTest(name=name):
                (self.out / name).symlink_to(mine)
                self.assert_error(self.run_it(), 2, name, "it is a link", "hint: ")
                (self.out / name).unlink()
                shutil.copytree(mine, self.out / name)
                self.assert_error(self.run_it(), 2, name, "notes.txt", "hint: ")
                self.assertTrue((self.out / name / "notes.txt").exists())
                shutil.rmtree(self.out / name)
        self.assertEqual((mine / "notes.txt").read_text(), "mine")

    def test_names_that_are_taken(self):
        (self.out / "report.json").mkdir(parents=True)
        self.assert_error(self.run_it(), 2, "report.json", "a folder has the name")
        (self.out / "report.json").rmdir()
        (self.out / "points").write_text("mine")
        self.assert_error(self.run_it(), 2, "points", "a file has the name")
        (self.out / "points").unlink()
        # Only the run itself knows its tiles: found before anything is delivered, and what is finished stays.
        (self.out / "points" / "500000_5300000.las").mkdir(parents=True)
        self.assert_error(self.run_it(), 1, "500000_5300000.las", "a folder has the name", "hint: ")
        self.assertFalse((self.out / "report.json").exists())
        self.assertTrue((self.out / ".swath").exists())
        (self.out / "points" / "500000_5300000.las").rmdir()
        done = self.run_it()
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertGreater(json.loads((self.out / "report.json").read_text())["pieces_resumed"], 0)

    def test_names_that_are_too_long(self):
        out = self.folder
        while len(str(out)) < 3900:
            out = out / ("x" * 200)
        self.assert_error(self.run_it(out), 2, "longer than this system takes", "hint: ")
        self.assert_error(self.run_it(self.out, "--set", "writers.las.folder=" + "y" * 250), 2, "longer than this system takes")
        self.assertFalse(self.out.exists())

    def test_every_product_of_a_plan_is_one_that_it_names(self):
        done = self.run_it()
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertEqual({p.name for p in self.out.iterdir()}, {"points", "report.json"})


class Removed(Case):
    simulated = SMALL

    def test_an_output_folder_that_goes_meanwhile(self):
        command = [SWATH, "run", CONFIG, "--survey", self.survey / "survey.toml", "--output", self.out, "--quiet",
                   *sets(["run.tile=100 m"])]
        subprocess.run(command, check=True)
        expected = products(self.out)
        met = 0
        for moment in ("*/strip_0001/strip.json", "*filters.noise*/*.done", "*terrain.dtm*/*.done", "*terrain.contours*/*.done",
                       "*writers.las*/*.done"):
            run = self.stopped_at(command, ".swath/" + moment)
            if run is None:
                continue
            met += 1
            shutil.rmtree(self.out)
            run.send_signal(signal.SIGCONT)
            _, error = run.communicate(timeout=300)
            with self.subTest(moment=moment):
                self.assertEqual(run.returncode, 1, "exit 0 without the products")
                self.assertEqual(error.count("error:"), 1, error)
                self.assertNotIn("terminate", error)
                again = subprocess.run(command, capture_output=True, text=True)
                self.assertEqual((again.returncode, again.stderr), (0, ""))
                self.assertEqual(products(self.out).keys(), expected.keys())
                self.assertEqual([name for name, data in products(self.out).items() if expected[name] != data], [])
        self.assertGreaterEqual(met, 3)

    def stopped_at(self, command, moment):
        """The run, held by SIGSTOP while it has the file `moment` and no products yet; None where it was missed five times."""
        for _ in range(5):
            shutil.rmtree(self.out, ignore_errors=True)
            run = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
            while run.poll() is None and not next(self.out.glob(moment), None):
                time.sleep(0.001)
            run.send_signal(signal.SIGSTOP)
            time.sleep(0.01)
            if run.poll() is None and self.out.exists() and not (self.out / "report.json").exists():
                return run
            run.send_signal(signal.SIGCONT)
            run.communicate(timeout=300)
        return None


class SurveyStages(Case):
    simulated = ["world.scene=hills", "world.length=400 m", "world.width=120 m", "flight.lines=2", "flight.cross_lines=0",
                 "flight.height=250 m", "scanner.prf=3 kHz", "mounting.deliver=truth"]

    def command(self, out, *options):
        return [SWATH, "run", FULL, "--survey", self.survey / "survey.toml", "--output", out, "--quiet", *sets(options)]

    def test_a_killed_run_does_not_smooth_or_compare_again(self):
        whole = self.folder / "whole"
        done = subprocess.run(self.command(whole), capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        run = subprocess.Popen(self.command(self.out))
        pattern = ".swath/*calib.strips*/survey.done"
        while run.poll() is None and not list(self.out.glob(pattern)):
            time.sleep(0.002)
        run.send_signal(signal.SIGKILL)
        self.assertEqual(run.wait(), -signal.SIGKILL, "it had ended before")
        done = subprocess.run(self.command(self.out, "run.keep_work=true"), capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        found = {name: data for name, data in products(self.out).items() if not name.startswith(".swath")}
        self.assertEqual([name for name in products(whole) if found.get(name) != products(whole)[name]], [])
        a, b = (json.loads((f / "report.json").read_text()) for f in (whole, self.out))
        self.assertGreaterEqual(b["pieces_resumed"], 3)
        for one, other in zip(a["stages"], b["stages"]):
            self.assertEqual((one.get("tally"), one.get("findings")), (other.get("tally"), other.get("findings")), one["type"])
        # Once more, with all of them done, and with one of them damaged.
        records = {p: p.stat().st_mtime_ns for p in self.out.glob(".swath/*/survey.done")}
        self.assertGreaterEqual(len(records), 4)
        subprocess.run(self.command(self.out, "run.keep_work=true"), check=True)
        self.assertEqual({p: p.stat().st_mtime_ns for p in records}, records)
        state = next(self.out.glob(".swath/*trajectory.ins_gnss*/handed_on.bin"))
        os.truncate(state, state.stat().st_size - 1)
        subprocess.run(self.command(self.out, "run.keep_work=true"), check=True)
        found = {name: data for name, data in products(self.out).items() if not name.startswith(".swath")}
        self.assertEqual([name for name in products(whole) if found.get(name) != products(whole)[name]], [])
        self.assertEqual(json.loads((self.out / "report.json").read_text())["pieces_damaged"], 1)


if __name__ == "__main__":
    unittest.main()
