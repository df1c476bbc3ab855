# SPDX-License-Identifier: GPL-3.0-or-later
"""Products do not depend on interruptions, threads or tiling."""
import json
import random
import shutil
import signal
import subprocess
import time
import unittest

from support import CONFIG, SMALL, SWATH, Case, las_records, products, raster, swath

KINDS = {".laz", ".tif", ".gpkg", ".dxf", ".geojson", ".png", ".vrt"}


class Killed(Case):
    simulated = SMALL
    KILLS = 10

    def command(self, out, *more):
        options = [word for option in ("run.tile=100 m", *more) for word in ("--set", option)]
        return [SWATH, "run", CONFIG, "--survey", self.survey / "survey.toml", "--output", out, "--quiet", *options]

    def test_a_run_killed_ten_times_gives_the_products_of_one_that_was_not(self):
        start = time.monotonic()
        whole = self.folder / "whole"
        subprocess.run(self.command(whole), check=True)
        takes = time.monotonic() - start
        expected = products(whole)
        self.assertEqual({suffix for name in expected for suffix in KINDS if name.endswith(suffix)}, KINDS)

        moments = random.Random(20260101)
        kills = resumed = 0
        while kills < self.KILLS:
            # Other threads and memory join other tiles.
            run = subprocess.Popen(self.command(self.out, f"run.threads={moments.choice((1, 2))}", f"run.memory={moments.choice(('600 MB', '2 GB'))}"))
            try:
                run.wait(timeout=moments.uniform(0.02, takes))
            except subprocess.TimeoutExpired:
                run.send_signal(signal.SIGKILL)
                run.wait()
                kills += 1
                continue
            # It was faster than its killer: what was killed before is continued and whole; the next kills meet a fresh run.
            self.assertEqual(run.returncode, 0)
            resumed += self.finished(expected)
        self.assertEqual(subprocess.run(self.command(self.out)).returncode, 0)
        resumed += self.finished(expected)
        self.assertGreater(resumed, 0, "no piece of a killed run was used again")

    def finished(self, expected):
        found = products(self.out)
        self.assertEqual(found.keys(), expected.keys())
        for name, data in expected.items():
            self.assertEqual(found[name] == data, True, f"{name} differs")
        self.assertFalse([name for name in found if ".part" in name or ".swath" in name])
        resumed = json.loads((self.out / "report.json").read_text())["pieces_resumed"]
        shutil.rmtree(self.out)
        return resumed

    def test_a_resumed_run_says_what_is_not_done_again(self):
        command = [c for c in self.command(self.out, "run.keep_work=true") if c != "--quiet"]
        first = subprocess.run(command, check=True, capture_output=True, text=True)
        self.assertNotIn("resumed", first.stdout + first.stderr)
        again = subprocess.run(command, check=True, capture_output=True, text=True)
        self.assertRegex(again.stderr, r"(?m)^resumed: [1-9]\d* flight lines? or files? and [1-9]\d* pieces? of other stages were done")
        self.assertRegex(again.stdout, r"(?m)^resumed: [1-9]\d* pieces")

    def test_what_a_kill_while_cleaning_up_leaves_goes_with_the_next_run(self):
        stage = self.out / ".swath-discarded" / "03-filters.noise-0123456789abcdef"
        stage.mkdir(parents=True)
        (stage / "rest").write_text("rest")
        subprocess.run(self.command(self.out), check=True)
        self.assertEqual([p.name for p in self.out.iterdir() if p.name.startswith(".")], [])

    def test_a_run_killed_with_other_options_is_not_mixed_in(self):
        run = subprocess.Popen(self.command(self.out, "ground.widest=30 m", "contours.interval=3 m"))
        time.sleep(0.6)
        run.send_signal(signal.SIGKILL)
        self.assertEqual(run.wait(), -signal.SIGKILL, "it had ended before")
        subprocess.run(self.command(self.out), check=True)
        whole = self.folder / "whole"
        subprocess.run(self.command(whole), check=True)
        self.assertEqual(products(self.out), products(whole))


class Threads(Case):
    simulated = SMALL

    def test_one_and_two_threads(self):
        for threads in (1, 2):
            self.run_ok(self.survey / "survey.toml", "--threads", str(threads), "--set", "run.tile=100 m", out=self.folder / str(threads))
        self.assertEqual(products(self.folder / "1"), products(self.folder / "2"))


class Tilings(Case):
    # Wide enough that tiles of 250 m cut the survey, whatever their corner.
    simulated = SMALL + ["world.length=400 m", "world.width=200 m"]

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.out_of = {}
        for tile in (250, 500):
            cls.out_of[tile] = cls.class_folder / str(tile)
            done = swath("run", CONFIG, "--survey", cls.survey / "survey.toml", "--output", cls.out_of[tile], "--quiet", "--set",
                         f"run.tile={tile} m", "--set", "writers.las.compress=false")
            assert done.returncode == 0, done.stderr

    def test_more_tiles_where_tiles_are_smaller(self):
        small, large = (len(list((self.out_of[t] / "points").glob("*.las"))) for t in (250, 500))
        self.assertGreater(small, large)

    def test_contours_and_picture_byte_for_byte(self):
        for name in ("contours.gpkg", "contours.dxf", "contours.geojson", "relief.png"):
            self.assertEqual((self.out_of[250] / name).read_bytes() == (self.out_of[500] / name).read_bytes(), True, name)

    def test_surfaces_value_for_value(self):
        for name, cells in (("dtm", 10000), ("dsm", 10000), ("dtm_quality", 10000), ("penetration", 1000)):
            a, b = (raster(self.out_of[t] / f"{name}.vrt") for t in (250, 500))
            self.assertGreater(len(a), cells, name)
            self.assertEqual(len(a.keys() ^ b.keys()), 0, name)
            self.assertEqual([place for place in a if a[place] != b[place]], [], name)

    def test_points_field_by_field(self):
        (a, coding_a), (b, coding_b) = (las_records(self.out_of[t] / "points") for t in (250, 500))
        self.assertEqual((len(coding_a), coding_a), (1, coding_b))
        self.assertEqual(len(a), len(b))
        self.assertEqual(a == b, True, "records differ")

    def test_counts(self):
        a, b = (json.loads((self.out_of[t] / "report.json").read_text()) for t in (250, 500))
        for one, other in zip(a["stages"], b["stages"]):
            self.assertEqual(one.get("counts"), other.get("counts"), one["type"])
            if one["type"].startswith("filters."):
                self.assertEqual(one.get("tally"), other.get("tally"), one["type"])


if __name__ == "__main__":
    unittest.main()
