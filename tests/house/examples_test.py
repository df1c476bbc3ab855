# SPDX-License-Identifier: GPL-3.0-or-later
"""Every example of --help and every command `swath ...` in README.md and docs/ is one that the program takes.

`run` becomes `check` on a small survey made here, with the same config and options; its flags are those of `swath run --help`. `simulate` and `demo` are ended
when they begin to write, and fail where they do not begin. Commands on files that an
example only names (`flight.laz`) may end with the error that there is no such file, those on an address with the error that no store is there. All others run as they are, in a scratch folder.
"""
import os
import re
import shlex
import shutil
import struct
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path
from unittest import mock

SWATH = os.environ.get("SWATH_PROGRAM") or sys.exit("SWATH_PROGRAM names no program")
ROOT = Path(__file__).resolve().parents[2]
PLACEHOLDERS = {"SURVEY": "survey", "DIR": "demo", "LENGTH": '"1 km"', "WIDTH": '"500 m"', "LINES": "2", "PRF": '"50 kHz"', "FREQUENCY": '"50 Hz"'}
SMALL = ["world.scene=hills", "world.length=300 m", "world.width=200 m", "flight.lines=2", "flight.cross_lines=0", "flight.height=300 m",
         "scanner.prf=2 kHz"]
CAMERA = [*SMALL, "output.laser=false", "output.trajectory=none", "events.file=true", "camera.file=true"]
SURVEYS = {"cloud": "cloud", "qc": "cloud", "classes": "cloud", "corridor": "cloud", "forest": "cloud", "buildings": "cloud", "terrain": "cloud", "copc": "cloud", "dtm": "cloud", "lever_arm": "hangar", "block": "camera", "colour": "photos", "orthophoto": "photos"}  # config: what it starts from
NO_STORE = {"AWS_S3_ENDPOINT": "127.0.0.1:9", "AWS_HTTPS": "NO", "AWS_VIRTUAL_HOSTING": "FALSE", "AWS_NO_SIGN_REQUEST": "YES"}  # no example reaches a network
LONGEST = 120  # s that a command may take, and a simulation before it begins to write


def blocks(text):
    """Blocks of code of a page: fenced, or indented by four after an empty line."""
    for fenced in re.findall(r"^```\w*\n(.*?)^```", text, re.M | re.S):
        yield fenced
    for indented in re.findall(r"(?:^(?: {4}.*)?\n)+", re.sub(r"^```.*?^```", "", text, flags=re.M | re.S), re.M):
        if indented.strip():
            yield re.sub(r"^ {4}", "", indented, flags=re.M)


def commands_of(block):
    """Commands of a block, continued lines joined."""
    lines = iter(block.splitlines())
    for line in lines:
        if not line.startswith("swath "):
            continue
        while True:
            try:
                words = shlex.split(line, comments=True)
            except ValueError:  # an open quote, or a backslash at the end
                words = None
            if words is not None and not line.endswith("\\"):
                yield words
                break
            following = next(lines, None)
            assert following is not None, line
            line = line.removesuffix("\\") + " " + following.strip()


def call(*words, cwd=None):
    return subprocess.run([SWATH, *words], capture_output=True, text=True, timeout=LONGEST, cwd=cwd, env={**os.environ, **NO_STORE})


def flags_of(text):
    """{flag: takes a value} of a command's help."""
    lines = re.findall(r"^  ((?:-\w,)?--[\w-]+)( [A-Z]+(?: \.\.\.)?)?(?: Needs: --[\w-]+)?(?:  |$)", text.split("Options:")[-1], re.M)
    return {name: bool(value) for names, value in lines for name in names.split(",")}


def fault_of_flags(words, known):
    """What is wrong with the flags of `run CONFIG FLAGS...`; None where nothing is. The config comes first."""
    rest = iter(words[2:])
    for word in rest:
        flag, has_value, _ = word.partition("=")
        if flag not in known:
            return f"{word} is not an option of swath run"
        if has_value and not known[flag]:
            return f"{flag} takes no value"
        if known[flag] and not has_value and next(rest, "--").startswith("--"):
            return f"{flag} lacks its value"
    return None


def help_examples():
    top = call("--help").stdout
    names = re.findall(r"^  (\w+)  ", top.split("Subcommands:")[1], re.M)
    for title, text in [("swath --help", top), *((f"swath {n} --help", call(n, "--help").stdout) for n in names)]:
        for line in re.findall(r"^  (swath .*)$", text.split("Usage:")[0], re.M):
            yield title, shlex.split(re.split(r" {3,}", line)[0].split(" > ")[0])


def page_examples():
    for page in [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]:
        for block in blocks(page.read_text(encoding="utf-8")):
            for words in commands_of(block):
                yield str(page.relative_to(ROOT)), words


def filled(word):
    """Placeholders in capitals replaced by values."""
    return re.sub("|".join(rf"\b{p}\b" for p in PLACEHOLDERS), lambda m: PLACEHOLDERS[m[0]].strip('"'), word)


def write_las(file):
    """LAS 1.2 with one point: enough for a check."""
    head = bytearray(227)
    head[0:4], head[24:26] = b"LASF", bytes((1, 2))
    struct.pack_into("<HII", head, 94, 227, 227, 0)
    struct.pack_into("<BHII", head, 104, 1, 28, 1, 1)
    struct.pack_into("<12d", head, 131, 0.001, 0.001, 0.001, 0, 0, 0, 500.0, 500.0, 500.0, 500.0, 500.0, 500.0)
    file.write_bytes(bytes(head) + struct.pack("<iiiHBBbBHd", 500000, 500000, 500000, 100, 0b1001, 0, 0, 0, 1, 1000.0))


class Examples(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = Path(tempfile.mkdtemp(prefix="swath-examples-"))
        shutil.copytree(ROOT / "configs", cls.folder / "configs")
        shutil.copytree(ROOT / "docs", cls.folder / "docs")
        (cls.folder / "bench").mkdir()
        cls.flags = flags_of(call("run", "--help").stdout)
        for config in (ROOT / "bench").glob("*.toml"):
            shutil.copy(config, cls.folder / "bench")
        done = call("simulate", cls.folder / "kinds/demo", "--quiet", *[f"--set={s}" for s in SMALL])
        assert done.returncode == 0, done.stderr
        done = call("simulate", cls.folder / "kinds/camera", "--quiet", *[f"--set={s}" for s in CAMERA])
        assert done.returncode == 0, done.stderr
        for kind, text in (("cloud", 'name = "cloud"\ncrs = "EPSG:32632"\n\n[[points]]\nfile = "cloud.las"\ncrs = "EPSG:32632"\n'),
                           ("photos", 'name = "cloud"\ncrs = "EPSG:32632"\n\n[[points]]\nfile = "cloud.las"\ncrs = "EPSG:32632"\n\n'
                            '[[photos]]\nfolder = "photos"\norientation = "orientation.csv"\ncamera = "camera.toml"\n'),
                           ("hangar", 'name = "hangar"\nhangar = "hangar.toml"\n')):
            (cls.folder / "kinds" / kind).mkdir()
            (cls.folder / "kinds" / kind / "survey.toml").write_text(text)
        write_las(cls.folder / "kinds/cloud/cloud.las")
        write_las(cls.folder / "kinds/photos/cloud.las")
        (cls.folder / "kinds/photos/photos").mkdir()
        (cls.folder / "kinds/photos/orientation.csv").write_text("image,x,y,z,omega,phi,kappa\n1,500,500,1500,0,0,0\n")
        (cls.folder / "kinds/photos/camera.toml").write_text('[[camera]]\nname = "a"\nf = "50 mm"\ncolumns = 10\nrows = 10\npixel = "5 um"\n')
        for page in (ROOT / "docs").glob("*.md"):  # configs that a page gives, named in a line of their own
            for block in blocks(page.read_text(encoding="utf-8")):
                named = re.search(r"^# (\w+\.toml)\n", block, re.M)
                if named:
                    (cls.folder / named[1]).write_text(block[named.start():])

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder, ignore_errors=True)

    def judge_run(self, words):
        if words[0] == "run":
            self.assertIsNone(fault_of_flags(words, self.flags))
        self.assertIn("--survey", words, "no survey is named")
        survey = self.folder / words[words.index("--survey") + 1]
        kind = SURVEYS.get(Path(words[1]).stem, "demo")
        for file in (self.folder / "kinds" / kind).iterdir():
            if file.is_file():
                survey.parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(file, survey.parent / file.name)
        if kind == "hangar":
            return call("check", words[1], *self.settings(words), cwd=self.folder)  # the page shows what is measured
        truth = self.folder / "kinds" / kind / "truth"
        if truth.exists():
            shutil.copytree(truth, survey.parent / "truth", dirs_exist_ok=True)
        return call("check", words[1], "--survey", str(survey), *self.settings(words), cwd=self.folder)

    def settings(self, words):
        return [w for k, w in enumerate(words) if w == "--set" or k and words[k - 1] == "--set"]

    def judge_simulate(self, words):
        with tempfile.TemporaryDirectory() as made:
            given = [f"{made}/x", *words[2:]]
            if words[0] == "demo":  # its folder is an option, here the first
                given = ["--output", f"{made}/x", *words[3 if words[1:2] == ["--output"] else 1:]]
            program = subprocess.Popen([SWATH, words[0], *given], cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
            end = time.monotonic() + LONGEST
            while program.poll() is None and not list(Path(made).glob("x/*")) and time.monotonic() < end:
                time.sleep(0.02)
            begun = bool(list(Path(made).glob("x/*")))
            if program.poll() is None:
                program.kill()
                program.communicate()
                return subprocess.CompletedProcess(words, 0 if begun else 1, "", "" if begun else f"nothing was written in {LONGEST} s")
            out, err = program.communicate()
            return subprocess.CompletedProcess(words, program.returncode, out, err)

    def judge(self, where, words):
        words = [filled(w) for w in words[1:]]
        with self.subTest(f"{where}: swath {shlex.join(words)}"):
            if words[0] == "run":
                done = self.judge_run(words)
            elif words[0] in ("simulate", "demo"):
                done = self.judge_simulate(words)
            else:
                if words[0] in ("check", "explain", "tasks"):
                    self.assertEqual(self.judge_run(words).returncode, 0)
                done = call(*words, cwd=self.folder)
            missing = re.search(r"error: (\S+): (?:.*no such (?:file|folder)|cannot read from the store)", done.stderr, re.I)
            if words[0] in ("info", "volumes", "profile", "map-dtm", "simulate", "plan", "block", "block-drift", "undistort", "dtm", "classify", "qc", "copc", "colour", "orthophoto", "init", "view") and missing and any(missing[1] in w for w in words):
                return  # the example's own file, which is not there
            if words[0] == "view" and "out: holds neither points nor a terrain model" in done.stderr:
                return  # the products of the page's run, which was checked and not made
            self.assertEqual(done.returncode, 0, done.stderr)

    def test_examples_of_the_help(self):
        found = list(help_examples())
        self.assertGreater(len(found), 15)
        for where, words in found:
            self.judge(where, words)

    def test_examples_of_the_pages(self):
        found = list(page_examples())
        self.assertGreater(len(found), 15)
        for where, words in found:
            self.judge(where, words)

    def test_a_simulation_that_hangs_is_a_fault(self):
        program = self.folder / "hangs"
        program.write_text("#!/bin/sh\nexec sleep 30\n")
        program.chmod(0o755)
        with mock.patch.multiple(sys.modules[__name__], SWATH=str(program), LONGEST=0.3):
            done = self.judge_simulate(["simulate", "x"])
            self.assertEqual((done.returncode, done.stderr), (1, "nothing was written in 0.3 s"))
            self.assertRaises(subprocess.TimeoutExpired, call, "info")

    def test_flags_of_run(self):
        for flag, takes_value in (("--survey", True), ("--output", True), ("--set", True), ("--threads", True), ("--quiet", False), ("--json-log", False)):
            self.assertEqual(self.flags.get(flag), takes_value, flag)
        right = ["run", "a.toml", "--survey", "s.toml", "--set", "a=1", "--threads=8", "--quiet"]
        self.assertIsNone(fault_of_flags(right, self.flags))
        for wrong in (["--resume"], ["--outputs", "x"], ["--quiet=1"], ["--output"], ["--output", "--quiet"], ["word"]):
            self.assertTrue(fault_of_flags(right + wrong, self.flags), wrong)

    def test_commands_are_found(self):
        page = 'Text\n\n    swath run a.toml --set x="1 m" \\\n      --set y=2   # why\n\n```sh\nswath info \'b\n c\'\n```\n'
        self.assertEqual([c for b in blocks(page) for c in commands_of(b)],
                         [["swath", "info", "b c"], ["swath", "run", "a.toml", "--set", "x=1 m", "--set", "y=2"]])


if __name__ == "__main__":
    unittest.main()
