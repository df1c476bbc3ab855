# SPDX-License-Identifier: GPL-3.0-or-later
"""The commands on good input: help, exit codes, what is printed where, every config of configs/."""
import json
import re
import subprocess
import tomllib
import unittest
from pathlib import Path

from support import CLOUD, CONFIG, SMALL, SMALLEST, SOURCE, SWATH, Case, products, schema_faults, stage, swath

COMMANDS = ["run", "check", "explain", "tasks", "task", "stages", "schema", "simulate", "info", "qc", "block-theory", "block-drift", "volumes", "profile", "map-dtm", "docs"]
CONFIGS = sorted((SOURCE / "configs").glob("*.toml"))


def trajectory_time(survey):
    """The line of a survey's [[trajectory]] that states its time scale."""
    time = tomllib.loads(survey.read_text())["trajectory"][0]["time"]
    return "time = {" + ", ".join(f"{k} = {json.dumps(v)}" for k, v in time.items()) + "}\n"


class Help(Case):
    def test_examples_stand_first(self):
        for command in [[], *([c] for c in COMMANDS)]:
            done = swath(*command, "--help")
            self.assertEqual(done.returncode, 0, command)
            self.assertEqual(done.stderr, "")
            lines = done.stdout.lstrip().split("\n")
            self.assertEqual(lines[0], "Examples", command)
            self.assertTrue(lines[1].startswith("  swath " + " ".join(command)), lines[1])
            self.assertIn("Exit codes: 0 done", done.stdout)

    def test_the_overview_tells_of_every_command_in_a_line(self):
        text = swath("--help").stdout
        overview = text[text.index("Subcommands:"):]
        for command in COMMANDS:
            self.assertRegex(overview, rf"(?m)^  {command} +\S")
        self.assertNotIn("Examples", overview)

    def test_options_of_one_meaning_have_one_form(self):
        commands = re.findall(r"(?m)^  ([a-z][a-z-]+) ", swath("--help").stdout.split("Subcommands:")[1])
        self.assertGreater(len(commands), 25)
        writing = set()
        for command in commands:
            options = swath(command, "--help").stdout.split("OPTIONS:")[-1]
            if re.search(r"(?m)^ .*--output\b", options):
                writing.add(command)
                self.assertRegex(options, r"(?m)^ +-o, *--output\b", command)
                if command != "explain":  # prints, and takes --output as an option of the run alone
                    self.assertRegex(options, r"(?m)^ +--quiet +Nothing but errors", command)
        self.assertLessEqual({"run", "dtm", "demo", "plan", "map-dtm", "profile", "block", "undistort", "task", "tasks"}, writing)
        self.assert_error(swath("map-dtm", "none.gpkg", "-o", self.folder / "map"), 1, "none.gpkg")
        self.assert_error(swath("map-dtm", "none.gpkg", "-o", ""), 2, "the name is empty")

    def test_a_reader_that_has_enough_is_no_fault(self):
        done = subprocess.run(["bash", "-o", "pipefail", "-c", f"'{SWATH}' schema | head -1"], capture_output=True, text=True, timeout=60)
        self.assertEqual((done.returncode, done.stderr), (0, ""))

    def test_a_cloud_in_place_of_a_survey(self):
        cloud = self.folder / "a.laz"
        cloud.write_bytes(b"LASF" + bytes(400))
        self.assert_error(swath("run", CONFIG, "--survey", cloud, "--output", self.folder / "out"), 2, "is a point cloud, not a survey",
                          "swath dtm ")

    def test_a_stage_by_the_name_behind_its_dot(self):
        self.assertTrue(swath("stages", "smrf").stdout.startswith("filters.smrf: "))
        self.assert_error(swath("stages", "las"), 2, "did you mean 'readers.las' or 'writers.las'")

    def test_info_of_several_files(self):
        table = self.folder / "a.csv"
        table.write_text("name,x,y,z\na,1,2,3\nb,4,5,6\n")
        one, two = swath("info", table), swath("info", table, table)
        self.assertEqual((two.returncode, two.stdout), (0, one.stdout + "\n" + one.stdout))
        self.assertEqual(len(json.loads(swath("info", table, table, "--json").stdout)), 2)

    def test_version(self):
        self.assertRegex(swath("--version").stdout, r"^swath \d+\.\d+\.\d+\n$")

    def test_wrong_usage(self):
        for arguments, word in ([[], "see swath --help"], [["rnu"], "did you mean 'run'"], [["run"], "CONFIG"],
                                [["run", CONFIG, "--nope"], "--nope"], [["run", "nowhere.toml"], "nowhere.toml"],
                                [["check", "nowhere.json"], "nowhere.json"], [["stages", "filters.smrff"], "filters.smrf"],
                                [["run", CONFIG, "--threads", "many"], "--threads"], [["run", CONFIG], "--survey"],
                                [["check", CONFIG, "--set", "ground.widets=30 m"], "did you mean 'widest'"],
                                [["check", CONFIG, "--set", "grond.widest=30 m"], "ground"], [["check", CONFIG, "--set", "cell"], "stage.key=value"],
                                [["simulate", "x", "--set", "sede=7"], "seed"]):
            with self.subTest(arguments=arguments):
                self.assert_error(swath(*arguments, cwd=self.folder), 2, re.escape(word))
        self.assertEqual(list(self.folder.iterdir()), [])

    def test_a_survey_without_its_option_is_named(self):
        for command in ("run", "check", "explain", "tasks"):
            self.assert_error(swath(command, "survey", "lech/survey.toml"), 2, f"name the survey by its option: swath {command} survey --survey lech/survey.toml")
        self.assert_error(swath("run", CONFIG, "lech/laser.npy"), 2, "'lech/laser.npy' has no place after the config", "records are named in a survey.toml")
        self.assert_error(swath("run", CONFIG, "flight.laz"), 2, "point clouds are given to `swath dtm`")
        self.assert_error(swath("run", CONFIG, "--survey", "a.toml", "b.toml"), 2, "'b.toml' has no place", "given by --survey")

    def test_a_unit_that_is_a_word_of_its_own_is_named(self):
        (self.folder / "a.laz").touch()
        for arguments, write in ((["dtm", "a.laz", "--cell", "1", "m"], "write --cell 1m or --cell \"1 m\""),
                                 (["dtm", "--contours", "2.5", "ft", "a.laz"], "write --contours 2.5ft"),
                                 (["check", CONFIG, "--set", "dtm.cell=50", "cm"], "write --set dtm.cell=50cm or --set \"dtm.cell=50 cm\""),
                                 (["simulate", "x", "--set", "flight.height=250", "m"], "--set flight.height=250m")):
            with self.subTest(arguments=arguments):
                self.assert_error(swath(*arguments, cwd=self.folder), 2, re.escape(write))
        (self.folder / "m").mkdir()
        self.assertNotIn("word of its own", swath("dtm", "a.laz", "--cell", "1", "m", cwd=self.folder).stderr)

    def test_words_of_other_programs_lead_to_a_command(self):
        for word, hint in (("contours", "swath dtm CLOUD --contours 1m"), ("convert", "swath copc CLOUD"), ("ground", "swath classify"),
                           ("survey", "it is a config: swath run survey"), ("netwrok", "did you mean the config 'network'"),
                           ("stage", "did you mean 'stages'"), ("zzzz", "see swath --help")):
            self.assert_error(swath(word), 2, f"'{word}' is not a command", re.escape(hint))

    def test_hints_name_commands_and_configs_that_are_there(self):
        source = (SOURCE / "tools" / "usage_fault.cpp").read_text()
        commands = set(re.findall(r"(?m)^  ([a-z][a-z-]+) ", swath("--help").stdout.split("Subcommands:")[1]))
        configs = {c.stem for c in CONFIGS}
        for hint in re.findall(r'"(`swath [^"]*)"}', source):
            for command, word in re.findall(r"`swath ([a-z]+) ?([a-z]*)", hint):
                self.assertIn(command, commands, hint)
                if command == "run" and word:
                    self.assertIn(word, configs, hint)

    def test_records_that_no_simulation_wrote_stay(self):
        real = self.folder / "real"
        real.mkdir()
        (real / "survey.toml").write_text('name = "Lech"\n')
        self.assert_error(swath("simulate", real, *(w for s in SMALLEST for w in ("--set", s))), 2, "the folder holds survey.toml, which no simulation wrote", "hint: ")
        self.assertEqual([p.name for p in real.iterdir()], ["survey.toml"])
        self.assertEqual((real / "survey.toml").read_text(), 'name = "Lech"\n')

    def test_bad_data_is_code_1(self):
        (self.folder / "a.las").write_bytes(b"no such thing")
        self.assert_error(swath("info", self.folder / "a.las"), 1, "a.las", "hint: ")


class Looks(Case):
    """Commands that write nothing."""
    simulated = SMALLEST + ['output.formats=["npy", "csv", "las", "laz"]']

    def test_check_passes_on_every_config(self):
        self.assertGreaterEqual(len(CONFIGS), 3)
        for config in CONFIGS:
            done = swath("check", config)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn(config.name, done.stdout)
        done = swath("check", CONFIG, "--survey", self.survey / "survey.toml")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("1 laser, 1 trajectory", done.stdout)
        quiet = swath("check", CONFIG, "--quiet")
        self.assertEqual((quiet.returncode, quiet.stdout, quiet.stderr), (0, "", ""))

    def test_check_tells_all_faults_at_once_with_their_places(self):
        config = self.folder / "faulty.toml"
        config.write_text('[run]\ntile = 500\n\n[[stage]]\ntype = "readers.las"\n\n[[stage]]\ntype = "filters.smrf"\ncel = "1 m"\n'
                          'slope = 99\n\n[[stage]]\ntype = "terrain.dmt"\n')
        self.assert_error(swath("check", config), 2, "4 faults", "faulty.toml:2:8", "faulty.toml:9:7.*did you mean 'cell'",
                          "faulty.toml:10:9", "faulty.toml:13:8.*terrain.dtm")

    def test_explain_tells_where_values_come_from(self):
        done = swath("explain", CONFIG, "--survey", self.survey / "survey.toml", "--set", "ground.widest=30 m", "--json")
        self.assertEqual(done.returncode, 0, done.stderr)
        told = json.loads(done.stdout)
        ground = next(s for s in told["stages"] if s["type"] == "filters.ground")["options"]
        self.assertEqual(ground["widest"]["from"], "--set")
        self.assertEqual(ground["steepest"]["from"], "default")
        dtm = next(s for s in told["stages"] if s["type"] == "terrain.dtm")["options"]
        self.assertRegex(dtm["cell"]["from"], r"survey_sbet\.toml:\d+:\d+")
        text = swath("explain", CONFIG)
        self.assertEqual(text.returncode, 0)
        self.assertIn("filters.ground", text.stdout)

    def test_explain_shows_addresses_as_they_are_written(self):
        done = swath("explain", "qc", "--set", "quality.surface.reference=s3://bucket/dtm.tif", "--json")
        self.assertEqual(done.returncode, 0, done.stderr)
        surface = next(s for s in json.loads(done.stdout)["stages"] if s["type"] == "quality.surface")["options"]
        self.assertEqual(surface["reference"]["value"], "s3://bucket/dtm.tif")

    def test_stages(self):
        done = swath("stages")
        names = [line.split()[0] for line in done.stdout.strip().split("\n")]
        self.assertIn("filters.smrf", names)
        for name in names:
            one = swath("stages", name)
            self.assertEqual(one.returncode, 0, one.stderr)
            self.assertTrue(one.stdout.startswith(name + ": "))
            self.assertIn("Options", one.stdout)

    def test_check_counts_stages(self):
        config = self.folder / "one.toml"
        config.write_text('[[stage]]\ntype = "readers.las"\n')
        self.assertIn("one.toml: its only stage is complete\n", swath("check", config).stdout)
        config.write_text('[[stage]]\ntype = "readers.las"\n[[stage]]\ntype = "writers.las"\n')
        self.assertIn("one.toml: 2 stages fit one another\n", swath("check", config).stdout)

    def test_schema_knows_every_stage(self):
        schema = json.loads(swath("schema").stdout)
        types = {one["properties"]["type"]["const"] for one in schema["properties"]["stage"]["items"]["anyOf"]}
        self.assertEqual(types, {line.split()[0] for line in swath("stages").stdout.strip().split("\n")})
        self.assertIn("laser", schema["$defs"]["survey"]["properties"])

    def test_info_of_every_format(self):
        for name, words in {"laser.npy": ["scan_angle_deg"], "laser.csv": ["range_m"], "laser.las": ["1.4"], "laser.laz": ["1.4"],
                            "sbet.out": ["SBET"], "smrmsg.out": ["smrmsg"], "survey.toml": ["EPSG:32632"],
                            "truth/dtm.tif": ["UTM zone 32N"]}.items():
            with self.subTest(file=name):
                done = swath("info", self.survey / name)
                self.assertEqual((done.returncode, done.stderr), (0, ""))
                for word in words:
                    self.assertIn(word, done.stdout)
                json.loads(swath("info", self.survey / name, "--json").stdout)

    def test_docs_are_up_to_date(self):
        done = swath("docs", SOURCE / "docs", "--check")
        self.assertEqual((done.returncode, done.stdout), (0, ""))
        made = swath("docs", self.folder / "docs")
        self.assertEqual(made.returncode, 0)
        self.assertIn("written:", made.stdout)
        self.assertEqual(swath("docs", self.folder / "docs", "--check").returncode, 0)
        (self.folder / "docs" / "run.md").write_text("old")
        stale = swath("docs", self.folder / "docs", "--check")
        self.assertEqual(stale.returncode, 1)
        self.assertIn("out of date:", stale.stdout)

    def test_simulate_again_gives_the_same_records(self):
        again = swath("simulate", self.folder / "again", *(w for s in self.simulated for w in ("--set", s)))
        self.assertEqual(again.returncode, 0)
        self.assertRegex(again.stderr, r"(?m)^simulate +100 %")
        self.assertNotIn("per mille", again.stderr)
        json.loads(again.stdout)
        self.assertEqual(products(self.folder / "again"), products(self.survey))
        mine = self.folder / "again" / "notes.txt"
        mine.write_text("kept")
        fewer = swath("simulate", self.folder / "again", *(w for s in [*self.simulated, 'output.formats=["csv"]'] for w in ("--set", s)))
        self.assertEqual(fewer.returncode, 0, fewer.stderr)
        self.assertEqual(sorted(p.name for p in (self.folder / "again").glob("laser.*")), ["laser.csv"])
        self.assertEqual(sorted(p.name for p in (self.folder / "again").glob("survey*")), ["survey.toml"])
        self.assertRegex(fewer.stderr, "removed: .*laser.las, laser.laz, laser.npy, .*survey_")
        self.assertTrue(mine.exists())


class Runs(Case):
    simulated = SMALLEST

    def arguments(self, *more):
        return ["run", CONFIG, "--survey", self.survey / "survey.toml", "--output", self.out, *more]

    def test_summary_on_standard_output_progress_on_standard_error(self):
        done = swath(*self.arguments())
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("products in", done.stdout)
        self.assertIn("rms_3d", done.stdout)
        self.assertRegex(done.stderr, r"(?m)^filters\.ground +100 %  \S+ k? ?points, .*/s, ")

    def test_quiet_is_silent(self):
        done = swath(*self.arguments("--quiet"))
        self.assertEqual((done.returncode, done.stdout, done.stderr), (0, "", ""))
        self.assertTrue((self.out / "report.json").exists())
        self.assertFalse((self.out / ".swath").exists())

    def test_json_log_is_one_object_per_line(self):
        done = swath(*self.arguments("--json-log"))
        self.assertEqual((done.returncode, done.stdout), (0, ""))
        lines = [json.loads(line) for line in done.stderr.strip().split("\n")]
        finished = [line["stage"] for line in lines if line.get("finished")]
        for name in ("strips", "filters.ground", "terrain.dtm", "writers.las"):
            self.assertIn(name, finished)
        for line in lines:
            self.assertIn("per_second", line)

    def test_the_report_counts_and_names_its_inputs(self):
        report = self.run_ok(self.survey / "survey.toml")
        for one in report["stages"]:
            if "counts" in one:
                left_out = sum(v["count"] for k, v in one.get("tally", {}).items() if k.endswith("left out"))
                self.assertEqual(one["counts"]["in"], one["counts"]["out"] + left_out, one["type"])
        self.assertEqual({Path(i["file"]).name for i in report["inputs"]}, {"laser.npy", "sbet.out", "smrmsg.out", "returns.npy", "dtm.tif"})
        self.assertEqual(stage(report, "terrain.dtm")["options"]["cell"]["value"], "1 m")

    def test_the_report_is_as_the_schema_says(self):
        report = self.run_ok(self.survey / "survey.toml")
        schema = json.loads(swath("schema").stdout)["$defs"]["report"]
        self.assertEqual(schema_faults(report, schema), [])
        for spoil in (lambda r: r.update(seconds="long"), lambda r: r["stages"][0].update(type="no.stage"), lambda r: r.update(unknown=1),
                      lambda r: r["inputs"][0].update(bytes=None)):
            spoilt = json.loads(json.dumps(report))
            spoil(spoilt)
            self.assertNotEqual(schema_faults(spoilt, schema), [])

    def test_a_missed_limit_is_code_3(self):
        done = swath(*self.arguments("--quiet", "--set", "run.limits.truth_rms=1 mm"))
        self.assertEqual(done.returncode, 3)
        self.assertRegex(done.stderr, r"run\.limits\.truth_rms = 0\.001 m is exceeded by 0\.\d+ m: .* 0\.\d+ m")
        limits = json.loads((self.out / "report.json").read_text())["limits"]
        self.assertFalse(next(one for one in limits if one["name"] == "truth_rms")["held"])
        self.assertTrue((self.out / "relief.png").exists(), "the products are there all the same")

    def test_every_config_runs(self):
        self.run_ok(self.survey / "survey.toml", config=CONFIG)
        self.run_ok(self.survey / "survey.toml", config=SOURCE / "configs" / "georeference.toml", out=self.folder / "georeferenced")
        tiles = sorted((self.folder / "georeferenced" / "points").glob("*.las"))
        survey = self.folder / "cloud.toml"
        survey.write_text('name = "cloud"\ncrs = "EPSG:32632"\n' + "".join(f'\n[[points]]\nfile = "{t}"\n' for t in tiles))
        report = self.run_ok(survey, config=CLOUD, out=self.folder / "cloud")
        self.assertEqual(stage(report, "writers.las")["counts"]["in"],
                         stage(json.loads((self.out / "report.json").read_text()), "writers.las")["counts"]["in"])
        for name, clouds in (("survey_classes.toml", self.survey / "survey.toml"), ("classes.toml", survey)):
            classes = stage(self.run_ok(clouds, config=SOURCE / "configs" / name, out=self.folder / name), "filters.classify")
            self.assertEqual(classes["counts"]["in"], classes["counts"]["out"])
        tiles = sorted((self.folder / "classes.toml" / "points").glob("*.laz"))
        classified = self.folder / "classified.toml"
        classified.write_text("".join(f'[[points]]\nfile = "{t}"\n' for t in tiles))
        terrain = self.run_ok(classified, config=SOURCE / "configs" / "terrain.toml", out=self.folder / "terrain")
        self.assertGreater(stage(terrain, "terrain.dtm")["tally"]["cells with a height"]["count"], 0)
        found = self.run_ok(survey, config=SOURCE / "configs" / "dtm.toml", out=self.folder / "dtm")
        self.assertGreater(stage(found, "terrain.dtm")["tally"]["cells with a height"]["count"], 0)
        lines = stage(self.run_ok(survey, config=SOURCE / "configs" / "corridor.toml", out=self.folder / "corridor"), "terrain.powerlines")
        self.assertEqual(lines["findings"]["spans"], 0)  # a scene without wires
        forest = stage(self.run_ok(survey, config=SOURCE / "configs" / "forest.toml", out=self.folder / "forest"), "terrain.forest")
        self.assertEqual(forest["findings"]["trees"], len((self.folder / "forest" / "trees.csv").read_text().splitlines()) - 1)
        buildings = stage(self.run_ok(survey, config=SOURCE / "configs" / "buildings.toml", out=self.folder / "buildings"), "terrain.buildings")
        city = json.loads((self.folder / "buildings" / "buildings.city.json").read_text())
        self.assertEqual(buildings["findings"]["buildings"], len(city["CityObjects"]))
        copc = self.run_ok(survey, config=SOURCE / "configs" / "copc.toml", out=self.folder / "copc")
        self.assertEqual(stage(copc, "writers.copc")["findings"]["points"], stage(report, "writers.las")["counts"]["in"])
        self.assertTrue((self.folder / "copc" / "points.copc.laz").exists())
        quality = self.run_ok(classified, config=SOURCE / "configs" / "qc.toml", out=self.folder / "quality")
        self.assertGreater(stage(quality, "quality.density")["findings"]["density"], 0.1)
        self.assertIn("Spatial distribution", (self.folder / "quality" / "quality.html").read_text())
        given = self.folder / "given.toml"  # a trajectory and nothing else
        given.write_text(f'[[trajectory]]\nfile = "{self.survey / "sbet.out"}"\n' + trajectory_time(self.survey / "survey.toml"))
        made = self.run_ok(given, config=SOURCE / "configs" / "convert_trajectory.toml", out=self.folder / "given")
        self.assertGreater(stage(made, "writers.trajectory")["findings"]["records"], 100)
        self.assertTrue((self.folder / "given" / "trajectory.sbet").exists())
        # survey.toml, trajectory.toml and events.toml, which need other records, run in navigation_test.py, lever_arm.toml in
        # lever_arm_test.py, strips.toml in strips_test.py, network.toml in network_test.py, calibrate.toml in calibration_test.py,
        # block.toml in block_run_test.py, colour.toml and orthophoto.toml in photos_test.py.
        known = {"survey.toml", "survey_sbet.toml", "trajectory.toml", "events.toml", "georeference.toml", "cloud.toml", "lever_arm.toml",
                 "strips.toml", "calibrate.toml", "classes.toml", "survey_classes.toml", "terrain.toml", "dtm.toml", "copc.toml", "corridor.toml",
                 "convert_trajectory.toml", "forest.toml", "buildings.toml", "qc.toml", "network.toml", "block.toml", "colour.toml", "orthophoto.toml"}
        self.assertEqual({c.name for c in CONFIGS}, known, "a new config is run here too")

    def test_the_config_as_json_gives_the_same_products(self):
        config = self.folder / "survey.json"
        config.write_text(json.dumps(tomllib.loads(CONFIG.read_text())))
        self.run_ok(self.survey / "survey.toml", out=self.folder / "toml")
        self.run_ok(self.survey / "survey.toml", config=config, out=self.folder / "json")
        self.assertEqual(products(self.folder / "toml"), products(self.folder / "json"))

    def test_set_changes_what_it_names(self):
        report = self.run_ok(self.survey / "survey.toml", "--set", "contours.interval=50 cm", "--set", "writers.las.compress=false",
                             "--set", "run.tile=250 m")
        self.assertEqual(stage(report, "terrain.contours")["options"]["interval"], {"value": "0.5 m", "from": "--set"})
        self.assertTrue(list((self.out / "points").glob("*.las")))
        self.assertFalse(list((self.out / "points").glob("*.laz")))

    def test_a_survey_without_truth_runs(self):
        survey = self.copy()
        text = (survey / "survey.toml").read_text()
        (survey / "survey.toml").write_text(text[:text.index("[truth]")])
        report = self.run_ok(survey / "survey.toml")
        self.assertNotIn("rms_3d", stage(report, "report.truth").get("findings", {}))


if __name__ == "__main__":
    unittest.main()
