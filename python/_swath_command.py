# SPDX-License-Identifier: GPL-3.0-or-later
"""The program `swath` of the wheel. Beside the package and not in it: the import of the package, with NumPy, takes a quarter of a second."""

from __future__ import annotations

import importlib.util
import os
import sys
from pathlib import Path

PACKAGE = Path(__file__).parent / "swath"


def environment_of(environment: dict[str, str], package: Path = PACKAGE) -> dict[str, str]:
    """The program's environment: PROJ finds the wheel's database unless PROJ_DATA names one."""
    spec = importlib.util.spec_from_file_location("_swath_wheel", PACKAGE / "_wheel.py")
    assert spec is not None and spec.loader is not None
    wheel = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(wheel)
    folders: list[str] = wheel.proj_folders(environment, package / "share")
    return environment | {"PROJ_DATA": os.pathsep.join(folders)} if folders else environment


def main() -> None:
    """Becomes the program."""
    os.execve(PACKAGE / "bin" / "swath", ["swath", *sys.argv[1:]], environment_of(dict(os.environ)))
