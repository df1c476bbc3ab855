# SPDX-License-Identifier: GPL-3.0-or-later
"""A full disk is one clear error; with space there, the same command finishes."""
import json
import os
import resource
import shutil
import subprocess
import unittest

from support import CONFIG, SMALL, Case, cloud_survey, products, swath


def may_mount(folder):
    if os.geteuid() != 0 or not shutil.which("mount"):
        return False
    if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=1m", "tmpfs", folder], capture_output=True).returncode != 0:
        return False
    subprocess.run(["umount", folder], check=True)
    return True


class Disk(Case):
    simulated = SMALL

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.reference = cls.class_folder / "reference"
        done = swath("run", CONFIG, "--survey", cls.survey / "survey.toml", "--output", cls.reference, "--quiet")
        assert done.returncode == 0, done.stderr

    def arguments(self, out):
        return ["run", CONFIG, "--survey", self.survey / "survey.toml", "--output", out, "--quiet"]

    def test_full_disk(self):
        disk = self.folder / "disk"
        disk.mkdir()
        if not may_mount(disk):
            self.skipTest("needs the right to mount a small disk")
        # Sizes at which strips, overlays, grids, contours, rasters and the picture are the first that do not fit.
        full = resumed = 0
        for kilobytes in (64, 400, 1200, 2400, 4000, 6000, 8000):
            with self.subTest(kilobytes=kilobytes):
                subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={kilobytes}k", "tmpfs", disk], check=True)
                try:
                    done = swath(*self.arguments(disk / "out"))
                    if done.returncode != 0:
                        full += 1
                        self.assert_error(done, 1, "No space left on device", "hint: the disk is full")
                        self.assertFalse((disk / "out" / "report.json").exists())
                        self.assertEqual([p for p in (disk / "out").rglob(".part*")], [], "a file half written stays")
                        subprocess.run(["mount", "-o", "remount,size=200m", disk], check=True)
                        done = swath(*self.arguments(disk / "out"))
                        resumed += json.loads((disk / "out" / "report.json").read_text())["pieces_resumed"] > 0
                    self.assertEqual((done.returncode, done.stderr), (0, ""))
                    self.assertEqual(products(disk / "out"), products(self.reference))
                    self.assertFalse((disk / "out" / ".swath").exists())
                finally:
                    subprocess.run(["umount", disk], check=True)
        self.assertGreaterEqual(full, 4, "the disks were too large to fill")
        self.assertGreaterEqual(resumed, 3, "finished work was thrown away")

    def test_full_disk_while_the_points_are_written(self):
        disk = self.folder / "disk"
        disk.mkdir()
        if not may_mount(disk):
            self.skipTest("needs the right to mount a small disk")
        survey = cloud_survey(self.folder / "survey", [(500000.0 + i % 200, 5300100.0 + i // 200, 100.0 + i % 7) for i in range(20000)])
        config = self.folder / "config.toml"
        kept = set()
        for ending in ("laz", "las"):
            config.write_text(f'[[stage]]\ntype = "readers.las"\n\n[[stage]]\ntype = "writers.las"\ncompress = {str(ending == "laz").lower()}\n')
            arguments = ["run", config, "--survey", survey, "--output", disk / "out", "--quiet"]
            for kilobytes in range(40, 2600, 20):
                subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={kilobytes}k", "tmpfs", disk], check=True)
                try:
                    done = swath(*arguments)
                    if done.returncode == 0:
                        break
                    self.assert_error(done, 1, "disk/out", "hint: the disk is full")
                    self.assertTrue((disk / "out" / ".swath").exists(), f"{kilobytes} kB: finished work was thrown away")
                    if not list((disk / "out").glob(".swath/*/strip_0001/strip.json")):
                        continue
                    kept.add(ending)
                    subprocess.run(["mount", "-o", "remount,size=200m", disk], check=True)
                    done = swath(*arguments)
                    self.assertEqual((done.returncode, done.stderr), (0, ""))
                    self.assertGreaterEqual(json.loads((disk / "out" / "report.json").read_text())["pieces_resumed"], 1)
                finally:
                    subprocess.run(["umount", disk], check=True)
        self.assertEqual(kept, {"laz", "las"}, "no disk was full while the points were written")

    def test_read_only_disk(self):
        disk = self.folder / "disk"
        disk.mkdir()
        if not may_mount(disk):
            self.skipTest("needs the right to mount a small disk")
        subprocess.run(["mount", "-t", "tmpfs", "-o", "ro", "tmpfs", disk], check=True)
        try:
            done = swath(*self.arguments(disk / "out"))
            self.assert_error(done, 1, "disk/out.*Read-only file system", "hint: choose a folder that you may write to")
            self.assert_error(swath("simulate", disk / "survey", "--quiet"), 1, "disk/survey.*Read-only file system")
        finally:
            subprocess.run(["umount", disk], check=True)

    def test_file_size_limit(self):
        # What cannot be mounted can be limited: writing past the limit fails as on a full disk.
        for kilobytes in (8, 40, 150):
            with self.subTest(kilobytes=kilobytes):
                out = self.folder / str(kilobytes)
                done = swath(*self.arguments(out),
                             preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (kilobytes * 1024, kilobytes * 1024)))
                self.assert_error(done, 1, "(?i)file too large|cannot")
                self.assertTrue((out / ".swath").exists(), "finished work was thrown away")
                done = swath(*self.arguments(out))
                self.assertEqual((done.returncode, done.stderr), (0, ""))
                self.assertEqual(products(out), products(self.reference))

    def test_simulation_on_a_full_disk(self):
        done = swath("simulate", self.folder / "survey", "--quiet",
                     preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (100000, 100000)))
        self.assert_error(done, 1, "(?i)file too large|cannot")
        self.assertFalse([p.name for p in (self.folder / "survey").rglob("*") if p.name.startswith(".part")])
        self.assertFalse((self.folder / "survey" / "survey.toml").exists(), "a survey that is not whole has no description")


if __name__ == "__main__":
    unittest.main()
