# SPDX-License-Identifier: GPL-3.0-or-later
"""The report of a run as dataclasses, which _generate.py makes of the declarations that report.json is made of."""

from __future__ import annotations

import dataclasses
import json
import os
import types
import typing
from pathlib import Path
from typing import Any

from . import _report_types
from ._errors import Error, usage_error
from ._report_types import Report as Report
from ._report_types import Stage as Stage


def _made(kind: Any, value: Any, key: str = "") -> Any:
    """A value of report.json as its type in the classes."""
    if value is None:
        return None
    origin = typing.get_origin(kind)
    if origin in (typing.Union, types.UnionType):
        return _made(next(k for k in typing.get_args(kind) if k is not type(None)), value, key)
    if origin is list:
        return [_made(typing.get_args(kind)[0], v, key) for v in value]
    if origin is dict:
        return {k: _made(typing.get_args(kind)[1], v, k) for k, v in value.items()}
    if kind is Stage:
        kind = _report_types.STAGES.get(value.get("type", ""), Stage)
    if not dataclasses.is_dataclass(kind):
        return value
    hints = typing.get_type_hints(kind)
    known: dict[str, Any] = {}
    for f in dataclasses.fields(kind):
        name = f.metadata.get("key", f.name)
        if f.name != "others" and name in value:
            known[f.name] = _made(hints[f.name], value[name], name)
    keys = {f.metadata.get("key", f.name) for f in dataclasses.fields(kind)}
    return kind(**known, others={k: v for k, v in value.items() if k not in keys})  # type: ignore[call-arg, operator]


def report_of(tree: dict[str, Any]) -> Report:
    """The report of what report.json holds."""
    report: Report = _made(Report, tree)
    report.tree = tree
    return report


def read_report(path: str | os.PathLike[str]) -> Report:
    """Reads report.json, or that of an output folder."""
    file = Path(path)
    if file.is_dir():
        file = file / "report.json"
    try:
        tree = json.loads(file.read_text(encoding="utf-8"))
    except OSError as fault:
        raise usage_error(f"cannot read: {fault.strerror}", str(file)) from None
    except ValueError as fault:
        raise Error(f"is not JSON: {fault}", str(file), "was the run finished?") from None
    if not isinstance(tree, dict) or "stages" not in tree:
        raise Error("is not the report of a run", str(file))
    return report_of(tree)
