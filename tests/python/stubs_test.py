# SPDX-License-Identifier: GPL-3.0-or-later
"""mypy on the package and on code that uses it; the stubs hold what the module has."""
import ast
import os
import shutil
import subprocess
import sys
import unittest
from pathlib import Path

from support import InFolder

import swath

PACKAGE = Path(swath.__file__).parent
GOOD = '''
import numpy as np
import swath

points = swath.read_points("a.laz")
ground = swath.ground(points, widest="80 m", keep_classes="none")
grid: swath.Grid = swath.dtm(ground, cell="50 cm")
lines: swath.Contours = swath.contours(ground, interval="1 m", dtm={"cell": "2 m"})


def flat(tile: swath.Tile) -> np.ndarray:
    return np.where(tile.z > 3, 1, 2)


report = swath.Pipeline("cloud.toml", survey="survey.toml", output="out").run(on_tile=flat, halo="10 m")
cells: int | None = report.stages[0].counts.out if report.stages[0].counts else None
try:
    swath.smooth(survey="survey.toml")
except swath.Error as e:
    print(e.what, e.where, e.hint)
'''
BAD = ['swath.ground(swath.read_points("a.laz"), wides="80 m")', 'swath.dtm(swath.read_points("a.laz"), cell=0.5)',
       'swath.ground(swath.read_points("a.laz"), keep_classes="nothing")', 'x: swath.Points = swath.dtm(swath.read_points("a.laz"))',
       'swath.Pipeline("a.toml").run().seconds.real.no_such']


class Stubs(InFolder):
    def mypy(self, *arguments, package=PACKAGE):
        done = subprocess.run([sys.executable, "-m", "mypy", "--strict", "--cache-dir", str(self.folder / "cache"), *map(str, arguments)],
                              capture_output=True, text=True, cwd=self.folder, env=os.environ | {"PYTHONPATH": str(package.parent)})
        return done.returncode, done.stdout + done.stderr

    def test_the_package_and_its_use(self):
        code, said = self.mypy(PACKAGE)
        self.assertEqual(code, 0, said)
        (self.folder / "good.py").write_text(GOOD)
        code, said = self.mypy(self.folder / "good.py")
        self.assertEqual(code, 0, said)
        for k, line in enumerate(BAD):
            (self.folder / f"bad{k}.py").write_text(f"import swath\n{line}\n")
        code, said = self.mypy(*(self.folder / f"bad{k}.py" for k in range(len(BAD))))
        for k, line in enumerate(BAD):
            self.assertIn(f"bad{k}.py:2: error", said, line)

    def test_a_fault_in_the_stubs_is_found(self):
        changed = self.folder / "changed/swath"
        shutil.copytree(PACKAGE, changed, ignore=shutil.ignore_patterns("*.so", "share"))
        stub = (changed / "_functions.pyi").read_text()
        begin = stub.index("def dtm(")
        end = stub.index(") -> Grid:", begin)
        (changed / "_functions.pyi").write_text(stub[:end] + ") -> Points:" + stub[end + len(") -> Grid:"):])
        (self.folder / "good.py").write_text(GOOD)
        code, said = self.mypy(self.folder / "good.py", package=changed)
        self.assertEqual(code, 1, said)
        self.assertIn("expression has type", said)

    def test_stubs_hold_every_name(self):
        names = lambda file: {n.name for n in ast.parse((PACKAGE / file).read_text()).body if isinstance(n, (ast.FunctionDef, ast.ClassDef))}
        self.assertEqual(names("_functions.pyi"), set(swath.FUNCTIONS))
        self.assertLessEqual({n for n in dir(swath._swath) if not n.startswith("_")} - {"version", "las_columns"}, names("_swath.pyi"))
        stub = (PACKAGE / "__init__.pyi").read_text()
        for name in swath.__all__:
            self.assertIn(name, stub)


if __name__ == "__main__":
    unittest.main()
