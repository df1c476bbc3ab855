# SPDX-License-Identifier: GPL-3.0-or-later
"""One command for one job: clouds by files, folders and patterns; the demonstration; a survey.toml proposed; completion and manual."""
import json
import os
import re
import shutil
import subprocess
import unittest
from pathlib import Path

from support import CONFIG, SMALL, SMALLEST, SOURCE, SWATH, Case, products, sets, swath

PROGRAM = Path(SWATH)


def is_sanitized():
    return "libasan" in subprocess.run(["ldd", SWATH], capture_output=True, text=True).stdout


class Jobs(Case):
    """A cloud made of a small simulated survey."""
    simulated = SMALL

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        out = cls.class_folder / "cloud"
        done = swath("run", "georeference", "--survey", cls.survey / "survey.toml", "--output", out, "--quiet")
        assert done.returncode == 0, done.stderr
        cls.clouds = out / "points"
        cls.files = sorted(cls.clouds.glob("*.las"))
        assert cls.files

    def test_terrain_of_a_folder_is_what_its_saved_config_gives(self):
        saved = self.folder / "mine.toml"
        done = swath("dtm", self.clouds, "-o", self.out, "--cell", "50cm", "--contours", "50 cm", "--save-config", saved, "--quiet")
        self.assertEqual((done.returncode, done.stdout, done.stderr), (0, "", ""))
        for name in ("dtm.vrt", "relief.png", "contours.gpkg", "report.json"):
            self.assertTrue((self.out / name).exists(), f"{name}: {sorted(p.name for p in self.out.iterdir())}")
        self.assertIn('cell = "50cm"', saved.read_text())
        again = self.folder / "again"
        done = swath("run", saved, "-o", again, "--quiet")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(products(self.out), products(again))

    def test_fine_cells_take_smaller_tiles(self):
        for given, side in (((), "400"), (("--set", "run.tile=250m"), "250")):
            saved = self.folder / f"{side}.toml"
            done = swath("dtm", self.files[0], "-o", self.out, "--cell", "20cm", "--crs", "EPSG:32632", *given, "--save-config", saved, "--quiet")
            self.assertRegex(saved.read_text(), rf'tile = "{side} ?m"', done.stderr)

    def test_close_contours_may_be_short(self):
        for given, length in (((), "2"), (("--set", "contours.min_length=500m"), "500")):
            saved = self.folder / f"{length}.toml"
            done = swath("dtm", self.files[0], "-o", self.folder / f"of {length} m", "--contours", "10cm", "--crs", "EPSG:32632", *given,
                         "--save-config", saved)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertRegex(saved.read_text(), rf'min_length = "{length} ?m"', done.stderr)
            self.assertEqual("contours.short" in done.stdout + done.stderr, length == "500", done.stdout + done.stderr)

    def test_contours_by_the_micrometre_are_refused(self):
        done = swath("dtm", self.files[0], "-o", self.out, "--contours", "0.01mm", "--crs", "EPSG:32632")
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertRegex(done.stderr, r"--contours 0\.01mm: contours every 0\.00001 m between heights of [\d.]+ and [\d.]+ m are \d+ levels")
        self.assertIn("hint: state an interval of ", done.stderr)

    def test_a_pipeline_of_pdal_is_what_our_own_stages_give(self):
        pipeline = self.folder / "x.json"
        pipeline.write_text("""{"pipeline": ["%s/*.las", {"type": "filters.smrf", "cell": 1.5}, {"type": "filters.range", "limits": "Classification[2:2]"},
            {"type": "writers.gdal", "filename": "pdal/dtm.tif", "resolution": 1, "output_type": "idw"}]}""" % self.clouds)
        saved = self.folder / "ours.toml"
        done = swath("run", pipeline, "--save-config", saved, cwd=self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("filters.smrf: filters.smrf with cell = \"1.5 m\"", done.stdout)
        ours = swath("run", saved, "-o", self.out, "--quiet")
        self.assertEqual(ours.returncode, 0, ours.stderr)
        self.assertEqual(products(self.folder / "pdal" / "dtm"), products(self.out))

    def test_the_folder_of_products_is_proposed(self):
        shutil.copy(self.files[0], self.folder / "flight.las")
        done = swath("dtm", "flight.las", cwd=self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertTrue((self.folder / "flight_dtm" / "dtm.vrt").exists())
        self.assertIn("flight_dtm", done.stdout)

    def test_own_classes_are_taken_where_asked_for(self):
        classified = swath("classify", self.clouds, "-o", self.out, "--quiet")
        self.assertEqual(classified.returncode, 0, classified.stderr)
        terrain = self.folder / "terrain"
        done = swath("dtm", str(self.out / "points" / "*.la[sz]"), "--classes", "2", "-o", terrain, "--quiet")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertNotIn("filters.ground", (terrain / "report.json").read_text())
        bad = swath("dtm", self.clouds, "--classes", "ground", "-o", terrain)
        self.assert_error(bad, 2, "--classes", "'ground' is not a class", "hint: ")
        none = swath("dtm", self.out / "points", "--classes", "77", "-o", self.folder / "none", "--quiet")
        self.assert_error(none, 1, "77", "hint: ")

    def test_bad_requests_are_one_error_each(self):
        cloud = self.files[0]
        self.assert_error(swath("dtm", "away.laz"), 2, "away.laz: no such file or folder", "hint: ")
        self.assert_error(swath("dtm", str(self.folder / "*.laz")), 2, "no file matches the pattern", "hint: ")
        self.assert_error(swath("dtm", self.folder), 2, "holds no LAS or LAZ file", "hint: ")
        self.assert_error(swath("dtm", cloud, "--cell", "50"), 2, "--cell.*'50': no unit", "hint: ")
        self.assert_error(swath("dtm", cloud, "--cell", "50kg"), 2, "'kg' is not a unit of length")
        self.assert_error(swath("dtm", cloud, "--crs", "EPSG:1"), 2, "--crs EPSG:1")
        self.assert_error(swath("dtm", cloud, "--set", "ground.cell=1 m", "-o", self.out), 2, "ground")
        text = self.folder / "text.laz"
        text.write_text("this is no cloud\n" * 100)
        self.assert_error(swath("dtm", text, "-o", self.out), 1, "text.laz")
        pipeline = self.folder / "x.json"
        pipeline.write_text('["%s",\n {"type": "filters.sample", "radius": 1}, "out.laz"]' % cloud)
        self.assert_error(swath("run", pipeline, "-o", self.out), 2, r"x\.json:2:\d+: 'filters.sample' has no counterpart here", "hint: ")
        self.assertFalse(self.out.exists())

    def test_what_is_typed_wrong_is_named_as_it_was_typed(self):
        cloud = self.files[0]
        for n in ("-3", "100000", "two"):
            self.assert_error(swath("dtm", cloud, "--threads", n, "-o", self.out), 2, f"'{n}' is not a number of threads", "1024")
        for command in ("dtm", "run"):
            self.assert_error(swath(command, cloud, "-o", ""), 2, "the name is empty")
        self.assert_error(swath("dtm", cloud, "--cell", "1km", "-o", self.out), 2, "--cell 1km: .*max_edge must span", "hint: .*--set dtm.max_edge=1km.*dtm.cell")
        self.assert_error(swath("dtm", cloud, "--cell", "1mm", "-o", self.out), 2, "--cell 1mm: the cell is too small", "hint: the smallest is (5 mm|0.005 m)")
        self.assert_error(swath("check", self.clouds), 2, "is a folder, and a config is needed", "hint: ")
        self.assert_error(swath("init", cloud), 2, "is a file, and a folder", "hint: ")
        self.assertFalse(self.out.exists())

    def test_a_projection_that_is_not_of_the_place_is_refused_or_warned_of(self):
        cloud = self.files[0]
        web = swath("dtm", cloud, "--crs", "EPSG:3857", "-o", self.out, "--quiet")
        self.assert_error(web, 2, "the map projection is not for this place: in WGS 84 / Pseudo-Mercator lengths", "hint: .*--crs EPSG:32632")
        self.assertFalse(self.out.exists())
        other = swath("dtm", cloud, "--crs", "EPSG:32635", "-o", self.out)
        self.assertEqual(other.returncode, 0, other.stderr)
        self.assertIn("warning [crs.outside]: the data lie", other.stdout)
        crs = json.loads((self.out / "report.json").read_text())["crs"]
        self.assertGreater(crs["degrees_outside"], 3)
        self.assertAlmostEqual(crs["scale"], 1.0, delta=0.03)

    def test_judging_needs_ground_and_check_points_before_the_work(self):
        self.assert_error(swath("qc", self.clouds, "-o", self.out, "--quiet"), 1, "no point is classified as ground", "hint: run `swath classify` first")
        self.assertFalse(self.out.exists())
        classified = swath("classify", self.clouds, "-o", self.folder / "classified", "--quiet")
        self.assertEqual(classified.returncode, 0, classified.stderr)
        marks = self.folder / "marks.csv"
        marks.write_text("name;x;y;z\nP0;650017,093;5300081.269;100,885\n")
        done = swath("qc", self.folder / "classified" / "points", "--check", marks, "-o", self.out)
        self.assert_error(done, 1, r"marks\.csv:2: '650017,093' is no number", "does the comma part decimals or thousands")
        self.assertNotIn("strips", done.stderr)
        self.assertFalse(self.out.exists())
        level = swath("qc", self.folder / "classified" / "points", "--level", "QL0", "-o", self.out, "--quiet")
        self.assertEqual(level.returncode, 3, level.stderr)
        self.assertRegex(level.stderr, r"\d of \d requirements? of QL0 (is|are) missed \(run.limits.quality_level allows 0\): ")


class Named(Case):
    simulated = SMALLEST

    def test_a_config_is_found_by_its_name(self):
        done = swath("check", "survey_sbet", "--survey", self.survey / "survey.toml")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.run_ok(self.survey / "survey.toml", config="survey_sbet")
        self.assert_error(swath("run", "survey_sbe"), 2, "no config of that name", "did you mean 'survey_sbet'")
        self.assert_error(swath("explain", "nothing_like_it"), 2, "there are .*survey")

    def test_a_program_without_its_configs_says_so(self):
        alone = shutil.copy(SWATH, self.folder / "swath")
        bare = {k: v for k, v in os.environ.items() if k != "SWATH_CONFIGS"}
        done = subprocess.run([alone, "dtm", "a.las"], capture_output=True, text=True, env=bare)
        self.assert_error(done, 2, "'dtm' is not a command, or one that needs the configs of the program, which are not found", "SWATH_CONFIGS names another folder")
        done = subprocess.run([alone, "demo", "-o", self.out], capture_output=True, text=True, env=bare)
        self.assert_error(done, 2, "no config of that name", "SWATH_CONFIGS")
        self.assertFalse(self.out.exists(), "nothing is simulated before")

    def test_configs_of_ones_own_come_first(self):
        shutil.copy(CONFIG, self.folder / "ours.toml")
        done = swath("check", "ours", env={**os.environ, "SWATH_CONFIGS": str(self.folder)})
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_a_proposed_survey_passes_check_once_it_is_completed(self):
        survey = self.copy()
        written = (survey / "survey.toml").read_text()
        self.assert_error(swath("init", survey), 2, "is there already", "--print")
        (survey / "survey.toml").unlink()
        done = swath("init", survey)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertRegex(done.stdout, r"written: .*survey\.toml, with \d+ of \d+ files")
        self.assertRegex(done.stdout, r"laser\[1\]\.time: ")
        proposed = (survey / "survey.toml").read_text()
        open_check = swath("check", "survey_sbet", "--survey", survey / "survey.toml")
        self.assert_error(open_check, 2, r"survey\.toml")
        self.assertIn("crs", open_check.stderr)
        (survey / "survey.toml").write_text(re.sub(r"# \? [^\n]*\n# ", "", proposed))
        done = swath("check", "survey_sbet", "--survey", survey / "survey.toml")
        self.assertEqual(done.returncode, 0, done.stderr + proposed)
        self.assertIn("[[laser]]", written)

    def test_init_of_what_is_no_survey(self):
        self.assert_error(swath("init", self.folder / "away"), 2, "no such folder", "hint: ")
        empty = self.folder / "empty"
        empty.mkdir()
        self.assert_error(swath("init", empty, "--quiet"), 1, "the folder holds no file", "hint: ")
        (empty / "notes.txt").write_text("nothing of a survey\n")
        self.assert_error(swath("init", empty, "--quiet"), 1, "its only file is not a record of a survey", "hint: ")
        self.assertFalse((empty / "survey.toml").exists())
        shown = swath("init", empty, "--print")
        self.assertEqual(shown.returncode, 0)
        self.assertIn("notes.txt", shown.stdout)


class Demo(Case):
    def test_from_nothing_to_products_with_errors_against_truth(self):
        # The smallest survey from whose records the trajectory is computed.
        small = ["world.scene=hills", "world.length=300 m", "world.width=200 m", "flight.lines=2", "flight.cross_lines=1",
                 "flight.height=300 m", "scanner.prf=2 kHz"]
        done = swath("demo", "-o", self.out, *sets(small))
        self.assertEqual(done.returncode, 0, done.stderr)
        for name in ("survey/survey.toml", "products/dtm.vrt", "products/relief.png", "products/report.json"):
            self.assertTrue((self.out / name).exists(), name)
        self.assertIn("report.truth", done.stdout)
        self.assertIn(str(self.out / "products" / "relief.png"), done.stdout)


class Shells(unittest.TestCase):
    def complete(self, *words):
        """What bash offers behind these words."""
        script = swath("completion", "bash").stdout + (
            f'\nCOMP_WORDS=({" ".join(map(repr, words))}); COMP_CWORD={len(words) - 1}; _swath; printf "%s\\n" "${{COMPREPLY[@]}}"\n')
        done = subprocess.run(["bash", "--norc", "-u", "-s"], input=script, capture_output=True, text=True, cwd=SOURCE / "configs")
        self.assertEqual(done.stderr, "")
        return done.stdout.split()

    def test_bash_offers_commands_options_stages_and_configs(self):
        self.assertEqual(self.complete("swath", "cla"), ["classify"])
        self.assertIn("--contours", self.complete("swath", "dtm", "--"))
        self.assertNotIn("--contours", self.complete("swath", "run", "--"))
        self.assertEqual(self.complete("swath", "dtm", "--set", "dtm.cel"), ["dtm.cell="])
        self.assertEqual(self.complete("swath", "stages", "filters.smr"), ["filters.smrf"])
        self.assertIn("survey_classes", self.complete("swath", "run", "survey"))
        self.assertEqual(self.complete("swath", "run", "--survey", "cloud"), ["cloud.toml"])
        self.assertEqual(self.complete("swath", "completion", "z"), ["zsh"])

    def test_a_flag_takes_no_value(self):
        self.assertIn("--set", self.complete("swath", "run", "--quiet", "--"))
        self.assertNotIn("--quiet) ", swath("completion", "bash").stdout)
        self.assertNotRegex(swath("completion", "zsh").stdout, r"--quiet\[[^\]]*\]:value")
        self.assertRegex(swath("completion", "bash").stdout, r"--survey\) .*value=1")

    def test_every_command_and_option_is_in_every_shell(self):
        commands = re.findall(r"(?m)^  ([a-z]+)  ", swath("--help").stdout.split("Subcommands:")[-1].split("SUBCOMMANDS:")[-1])
        self.assertGreater(len(commands), 10)
        for shell in ("bash", "zsh", "fish"):
            script = swath("completion", shell).stdout
            for command in commands:
                self.assertIn(command, script)
            for option in ("contours", "save-config", "json-log"):
                self.assertIn(option, script)

    def test_shells_take_their_scripts(self):
        for shell, arguments in (("bash", ["-n"]), ("zsh", ["-n"]), ("fish", ["--no-execute"])):
            if not shutil.which(shell):
                continue
            done = subprocess.run([shell, *arguments], input=swath("completion", shell).stdout, capture_output=True, text=True)
            self.assertEqual((done.returncode, done.stderr), (0, ""), shell)

    def test_an_unknown_shell_is_refused(self):
        done = swath("completion", "tcsh")
        self.assertEqual(done.returncode, 2)
        self.assertIn("tcsh", done.stderr)

    def test_the_manual_has_every_option_and_no_fault(self):
        page = swath("man").stdout
        self.assertTrue(page.startswith(".TH SWATH 1"))
        for word in (".SS swath dtm CLOUD...", "\\-\\-contours VALUE", ".SH EXIT STATUS", "SWATH_CONFIGS"):
            self.assertIn(word, page)
        if shutil.which("groff"):
            done = subprocess.run(["groff", "-man", "-ww", "-Tutf8", "-z"], input=page, capture_output=True, text=True)
            self.assertEqual((done.returncode, done.stderr), (0, ""))


@unittest.skipIf(is_sanitized(), "GDAL is linked as usual there")
class Start(unittest.TestCase):
    def libraries(self, *arguments):
        done = subprocess.run([SWATH, *map(str, arguments)], capture_output=True, text=True, env={**os.environ, "LD_DEBUG": "files"})
        return set(re.findall(r"calling init: (\S+)", done.stderr))

    def test_what_help_does_not_need_is_not_loaded(self):
        at_start = self.libraries("--help")
        self.assertFalse([name for name in at_start if "libgdal" in name or "libpcl_" in name and "libpcl_common" not in name], at_start)
        # 84 on Debian 12; GDAL would bring 62 more.
        self.assertLess(len(at_start), 100)

    def test_gdal_is_there_when_a_file_needs_it(self):
        picture = SOURCE / "docs" / "pictures" / "relief.png"
        self.assertTrue([name for name in self.libraries("info", picture) if "libgdal" in name])


if __name__ == "__main__":
    unittest.main()
