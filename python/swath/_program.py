# SPDX-License-Identifier: GPL-3.0-or-later
"""The program `swath` of the wheel."""

from __future__ import annotations

import os
import sys
from pathlib import Path


def main() -> None:
    """Becomes the program; PROJ finds its database beside it unless the environment names another."""
    package = Path(__file__).parent
    data = package / "proj"
    if (data / "proj.db").is_file():
        os.environ.setdefault("PROJ_DATA", str(data))
    program = package / "bin" / "swath"
    os.execv(program, ["swath", *sys.argv[1:]])
