# SPDX-License-Identifier: GPL-3.0-or-later
"""docs/add-a-stage.md adds a filter: its own text, put in a scratch tree, compiles, passes its test, and runs in the program.

Only what the page adds is compiled, with the flags of the build: the three files and the registry. All else is linked from the build's objects.
"""
import json
import os
import re
import shlex
import subprocess
import sys
import tempfile
import textwrap
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
BUILD = Path(os.environ.get("SWATH_BUILD") or sys.exit("SWATH_BUILD names no build"))
PAGE = ROOT / "docs" / "add-a-stage.md"
FILES = re.compile(r"^\d\. `([^`]+\.(?:h|cpp))`.*?^ +```cpp\n(.*?)^ +```", re.M | re.S)
LINES = re.compile(r"^\d\. One (?:name|line) in (?:the list of )?`([^`]+)`.*?^ +```\w+\n(.*?)^ +```", re.M | re.S)


def run(*words, cwd=None):
    done = subprocess.run(words, capture_output=True, text=True, cwd=cwd, timeout=600)
    return done.returncode, done.stdout + done.stderr


def compile_command(of, source, tree):
    """The build's command for the file `of`, for `source` in the scratch tree, whose headers come first."""
    entries = json.loads((BUILD / "compile_commands.json").read_text())
    entry = next(e for e in entries if e["file"] == str(ROOT / of) or (str(ROOT / of) in Path(e["file"]).read_text()))
    words = shlex.split(entry["command"])
    words = words[next(i for i, w in enumerate(words) if re.search(r"(c|g|clang)\+\+(-[0-9.]+)?$", w)):]
    out = str(tree / (Path(source).name + ".o"))
    words[words.index("-o") + 1] = out
    words[words.index("-c") + 1] = str(tree / source)
    return [words[0], f"-I{tree}", *words[1:]], out, entry["directory"]


def link_command(target, objects, out, keep=True):
    """The build's command that links a program, with objects in front of its libraries, beside or in place of its own."""
    said = run("ninja", "-C", str(BUILD), "-t", "commands", "-s", target)[1].splitlines()
    words = shlex.split(next(part for line in said for part in line.split(" && ") if f" -o {target} " in part))
    words[words.index("-o") + 1] = str(out)
    if not keep:
        words = [w for w in words if not w.endswith(".o")]
    at = next(i for i, w in enumerate(words) if w.endswith((".a", ".so")))
    return [*words[:at], *objects, "-Wl,-z,muldefs", *words[at:]]  # the first definition of the registry counts, also in a build by folders


class AddAStage(unittest.TestCase):
    def test_the_page_adds_a_filter(self):
        page = PAGE.read_text().split("## A stage that works once")[0]
        files = {name: textwrap.dedent(text) for name, text in FILES.findall(page)}
        lines = {name: textwrap.dedent(text).strip() for name, text in LINES.findall(page)}
        self.assertEqual(len(files), 3, "three files")
        self.assertEqual(sorted(lines), ["filters/CMakeLists.txt", "stages/registry.cpp"], "two lines")
        unit = lines["filters/CMakeLists.txt"]
        for name in (f"filters/{unit}.h", f"filters/{unit}.cpp", f"tests/filters/{unit}_test.cpp"):
            self.assertIn(name, files)
            self.assertFalse((ROOT / name).exists(), f"{name} is there already: the page needs another example")
        with tempfile.TemporaryDirectory() as folder:
            tree = Path(folder)
            for name, text in files.items():
                (tree / name).parent.mkdir(parents=True, exist_ok=True)
                (tree / name).write_text(text)
            registry = (ROOT / "stages/registry.cpp").read_text()
            registry, n = re.subn(r"(?=^ *breaklines_stage\(\))", lines["stages/registry.cpp"] + "\n", registry, flags=re.M)
            self.assertEqual(n, 1)
            (tree / "stages").mkdir()
            (tree / "stages/registry.cpp").write_text(f'#include "filters/{unit}.h"\n' + registry)
            objects = {}
            for like, source in (("filters/noise/outlier.cpp", f"filters/{unit}.cpp"), ("stages/registry.cpp", "stages/registry.cpp"),
                                 ("tests/filters/noise/outlier_test.cpp", f"tests/filters/{unit}_test.cpp")):
                command, objects[source], place = compile_command(like, source, tree)
                code, said = run(*command, cwd=place)
                self.assertEqual(code, 0, f"{source}:\n{said}")
            added = [objects[f"filters/{unit}.cpp"], objects["stages/registry.cpp"]]
            tested = [objects[f"filters/{unit}.cpp"], objects[f"tests/filters/{unit}_test.cpp"]]
            for words in (link_command("tools/swath", added, tree / "swath"),
                          link_command("tests/filters_tests", tested, tree / "test", keep=False)):
                code, said = run(*words, cwd=BUILD)
                self.assertEqual(code, 0, said)
            suite = re.search(r"TEST\((\w+),", files[f"tests/filters/{unit}_test.cpp"])[1]
            code, said = run(str(tree / "test"), f"--gtest_filter={suite}.*")
            self.assertEqual(code, 0, said)
            self.assertIn("1 test from 1 test suite ran", said)
            stage = re.search(r'"(filters\.\w+)"', lines["stages/registry.cpp"])[1]
            code, said = run(str(tree / "swath"), "stages", stage)
            self.assertEqual(code, 0, said)
            for option in re.findall(r'v\.option\("(\w+)"', files[f"filters/{unit}.h"]):
                self.assertIn(option, said)


if __name__ == "__main__":
    unittest.main()
