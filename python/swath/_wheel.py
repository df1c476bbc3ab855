# SPDX-License-Identifier: GPL-3.0-or-later
"""What a wheel brings with it beside libraries: PROJ's database, the charts' typeface. A build from source has none of them."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path

SHARE = Path(__file__).parent / "share"


def proj_folders(environment: Mapping[str, str], share: Path = SHARE) -> list[str]:
    """Folders in which PROJ is to look for its database and grids: those that PROJ_DATA names, then the wheel's own.

    Empty where PROJ's own search is right: the wheel has no database, or a folder of PROJ_DATA (or PROJ_LIB) holds one.
    """
    own = share / "proj"
    stated = [f for f in (environment.get("PROJ_DATA") or environment.get("PROJ_LIB") or "").split(os.pathsep) if f]
    if not (own / "proj.db").is_file() or any((Path(f) / "proj.db").is_file() for f in stated):
        return []
    return [*stated, str(own)]


def users_proj_folder(environment: Mapping[str, str]) -> str:
    """The folder of grids that `projsync` fetched for this user."""
    home = environment.get("HOME", "")
    data = environment.get("XDG_DATA_HOME") or (f"{home}/.local/share" if home else "")
    return environment.get("PROJ_USER_WRITABLE_DIRECTORY") or (f"{data}/proj" if data else "")


def typeface(environment: Mapping[str, str], share: Path = SHARE, system: Path = Path("/etc/fonts/fonts.conf")) -> str:
    """fontconfig's settings for the wheel's own typeface, where the system has none; empty otherwise."""
    own = share / "swath/fonts/fonts.conf"
    return str(own) if own.is_file() and not system.is_file() and not environment.get("FONTCONFIG_FILE") else ""
