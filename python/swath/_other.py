# SPDX-License-Identifier: GPL-3.0-or-later
"""What files hold, and which stages there are."""

from __future__ import annotations

import json
import os
from typing import Any

from . import _swath
from ._runs import declared


def describe_file(path: str | os.PathLike[str]) -> dict[str, Any]:
    """What a file holds and what looks wrong in it, as `swath info` says it: points, records, rasters, vectors."""
    found: dict[str, Any] = json.loads(_swath.describe_file(os.fspath(path)))
    return found


def stages() -> dict[str, str]:
    """The stages of pipelines with their summaries, in the order of the chain."""
    return {name: d["summary"] for name, d in declared().items()}
