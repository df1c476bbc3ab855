# SPDX-License-Identifier: GPL-3.0-or-later
"""The program of a wheel: a launcher that loads a Python module outside of Python (python/launcher.cpp, cmake/python_names.cmake).

The module here is a small one. scripts/test_packages.sh runs that of a wheel.
"""
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2]
MODULE = """
extern "C" {
extern int PyExc_ValueError, _Py_NoneStruct;
int PyLong_AsLong(void*);
int* names[] = {&PyExc_ValueError, &_Py_NoneStruct};
int interpreter() { return PyLong_AsLong(names[0]); }
ENTRY int swath_program(int count, char** words) { return count == 3 && words[2][0] == 'x' ? 42 : 1; }
}
"""


class Launcher(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.module = self.folder / "package/_module.so"
        self.program = self.folder / "package/bin/swath"
        self.program.parent.mkdir(parents=True)

    def build(self, *flags):
        (self.folder / "module.cpp").write_text(MODULE)
        done = lambda *command: subprocess.run(command, cwd=self.folder, check=True, capture_output=True, text=True)
        compiler = os.environ["CXX"]
        done(compiler, "-shared", "-fPIC", *flags, "-Wl,-z,now", "-o", self.module, "module.cpp")
        done("cmake", f"-DMODULE={self.module}", f"-DNM={os.environ['NM']}", "-DOUTPUT=names.s", "-P", SOURCE / "cmake/python_names.cmake")
        done(compiler, "-std=c++20", "-rdynamic", "-fvisibility=hidden", f'-DSWATH_MODULE="{self.module.name}"', SOURCE / "python/launcher.cpp", "names.s",
             "-o", self.program, "-ldl")

    def call(self, *words):
        return subprocess.run([self.program, *words], capture_output=True, text=True)

    def test_words_and_exit_code_pass_through_a_link_too(self):
        self.build("-DENTRY=")
        self.assertEqual(self.call("demo", "x").returncode, 42)
        self.assertEqual(self.call("demo").returncode, 1)
        link = self.folder / "link"
        link.symlink_to(self.program)
        self.assertEqual(subprocess.run([link, "demo", "x"]).returncode, 42)

    def test_a_package_without_its_module_is_named(self):
        self.build("-DENTRY=static")
        without = self.call("demo", "x")
        self.assertEqual((without.returncode, "swath_program" in without.stderr), (1, True), without.stderr)
        self.module.unlink()
        gone = self.call("demo", "x")
        self.assertEqual(gone.returncode, 1)
        self.assertIn("_module.so", gone.stderr)
        self.assertIn("install the package again", gone.stderr)


if __name__ == "__main__":
    sys.exit(unittest.main())
