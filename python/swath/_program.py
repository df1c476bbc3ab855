# SPDX-License-Identifier: GPL-3.0-or-later
"""The program `swath` of the wheel."""

from __future__ import annotations

import os
import sys
from pathlib import Path

from ._wheel import proj_folders


def environment_of(environment: dict[str, str]) -> dict[str, str]:
    """The program's environment: PROJ finds the wheel's database unless PROJ_DATA names one."""
    folders = proj_folders(environment)
    return environment | {"PROJ_DATA": os.pathsep.join(folders)} if folders else environment


def main() -> None:
    """Becomes the program."""
    program = Path(__file__).parent / "bin" / "swath"
    os.execve(program, ["swath", *sys.argv[1:]], environment_of(dict(os.environ)))
