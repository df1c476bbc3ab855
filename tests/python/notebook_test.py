# SPDX-License-Identifier: GPL-3.0-or-later
"""The notebooks of the documentation run from top to end."""
import os
import unittest

import nbformat
from nbclient.exceptions import CellExecutionError
from nbconvert.preprocessors import ExecutePreprocessor
from support import SOURCE, InFolder


class Notebooks(InFolder):
    def test_they_run(self):
        notebooks = sorted((SOURCE / "docs/notebooks").glob("*.ipynb"))
        self.assertGreaterEqual(len(notebooks), 1)
        os.environ.setdefault("IPYTHONDIR", str(self.folder / "ipython"))
        for file in notebooks:
            with self.subTest(file.name):
                notebook = nbformat.read(file, as_version=4)
                for cell in notebook.cells:
                    self.assertFalse(cell.get("outputs"), "outputs are not committed")
                try:
                    ExecutePreprocessor(timeout=600, kernel_name="python3").preprocess(notebook, {"metadata": {"path": str(self.folder)}})
                except CellExecutionError as fault:
                    self.fail(str(fault))
                said = "".join(o.get("text", "") for c in notebook.cells for o in c.get("outputs", []))
                self.assertIn("rms", said)


if __name__ == "__main__":
    unittest.main()
