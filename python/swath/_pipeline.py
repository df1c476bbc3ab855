# SPDX-License-Identifier: GPL-3.0-or-later
"""Pipelines of files, with a function of the user's as a stage on tiles."""

from __future__ import annotations

import functools
import hashlib
import inspect
import json
import os
import types
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from . import _swath
from ._columns import Array
from ._errors import usage_error
from ._report import Report, report_of
from ._runs import plain

CONFIGS = Path(__file__).parent / "share/swath/configs"


@dataclass(frozen=True, eq=False)
class Tile:
    """Points of one tile and of the halo around it: NumPy views of the run's own columns, the tile's points first.

    columns: by the names that docs/python.md lists; x, y, z in metres relative to origin. classification may be written to: what is written
    to the first `own` is kept. own: number of the tile's own points. box: west, south, east, north of the tile, metres. origin: of x, y, z.
    Several neighbouring tiles may come as one.
    """

    columns: Mapping[str, Array]
    own: int
    box: tuple[float, float, float, float]
    origin: tuple[float, float, float]

    def __getattr__(self, name: str) -> Array:
        columns = object.__getattribute__(self, "columns")
        if name in columns:
            column: Array = columns[name]
            return column
        raise AttributeError(f"the tile has no column '{name}'; it has " + ", ".join(columns))

    def __len__(self) -> int:
        return len(self.columns["x"])


OnTile = Callable[[Tile], Any]


def _code_of(function: Any) -> str:
    """Distinguishes functions: equal for the same code, so that equal runs give equal files."""
    parts: list[bytes] = []

    def add(code: types.CodeType) -> None:
        parts.append(code.co_code + repr((code.co_names, code.co_varnames)).encode())
        for constant in code.co_consts:
            add(constant) if isinstance(constant, types.CodeType) else parts.append(repr(constant).encode())

    while isinstance(function, functools.partial):
        parts.append(repr((function.args, sorted(function.keywords.items()))).encode())
        function = function.func
    code = getattr(inspect.unwrap(function), "__code__", None) or getattr(getattr(type(function), "__call__", None), "__code__", None)
    add(code) if code else parts.append(repr(type(function)).encode())
    return hashlib.sha256(b"\0".join(parts)).hexdigest()[:16]


def _on_tile(function: OnTile) -> Callable[..., Array | None]:
    """What a run calls: checks what the function returns."""

    def call(columns: dict[str, Array], own: int, box: Any, origin: Any) -> Array | None:
        classes = function(Tile(types.MappingProxyType(columns), own, box, origin))
        if classes is None:
            return None
        given = np.asarray(classes)
        if given.ndim != 1 or len(given) not in (own, len(columns["x"])):
            raise usage_error(f"returned an array of shape {given.shape}; the tile has {own} points of its own and {len(columns['x'])} with its halo",
                              "on_tile", "return one class for each of them, or None")
        given = given[:own]
        if given.dtype.kind not in "bui" or (len(given) and (given.min() < 0 or given.max() > 255)):
            raise usage_error(f"returned {given.dtype} numbers that are not classes", "on_tile", "classes are whole numbers from 0 to 255")
        return np.ascontiguousarray(given, np.uint8)

    return call


class Pipeline:
    """A pipeline on a survey, as `swath run` does it.

    config: a file (.toml, .json), a dict of the same form, or the name of a pipeline that comes with the package ("survey", "cloud",
    "terrain" ...). survey: a survey.toml; output: the folder of the products; both in place of the config's. sets: options by stage and
    name, {"dtm.cell": "50 cm", "run.tile": "250 m"}. threads: 0 one per processor. Nothing is read before run(), check() or explain().
    """

    def __init__(self, config: str | os.PathLike[str] | Mapping[str, Any], survey: str | os.PathLike[str] | None = None,
                 output: str | os.PathLike[str] | None = None, sets: Mapping[str, Any] | None = None, threads: int | None = None) -> None:
        self.config = config
        self.survey = survey
        self.output = output
        self.sets = dict(sets or {})
        self.threads = threads

    def __repr__(self) -> str:
        return f"swath.Pipeline({self.config!r}, survey={self.survey!r}, output={self.output!r}, sets={self.sets!r})"

    def _request(self) -> dict[str, Any]:
        request: dict[str, Any] = {
            "survey": os.fspath(self.survey or ""), "output": os.fspath(self.output or ""), "threads": self.threads,
            "sets": [f"{k}={v if isinstance(v, str) else json.dumps(plain(v))}" for k, v in self.sets.items()]}
        if isinstance(self.config, Mapping):
            return request | {"config": "the config", "tree": json.dumps(plain(self.config))}
        name = os.fspath(self.config)
        if not os.path.exists(name) and (CONFIGS / f"{name}.toml").is_file():
            name = str(CONFIGS / f"{name}.toml")
        return request | {"config": name}

    def check(self) -> None:
        """Raises Error with every fault of config and survey, without reading data."""
        _swath.explain(self._request())

    def explain(self) -> dict[str, Any]:
        """Every effective option with where its value comes from."""
        found: dict[str, Any] = json.loads(_swath.explain(self._request()))
        return found

    def run(self, on_tile: OnTile | None = None, *, halo: str = "0 m", columns: Sequence[str] | None = None, after: str | None = None,
            progress: bool = False) -> Report:
        """Runs the pipeline, or goes on from where a run that was killed or interrupted (Ctrl-C) stopped; returns its report.

        on_tile: a function of a Tile that gives classes: it returns one class per point, or writes to tile.classification and returns
        None. It is called for every tile (several at once where there are threads, with Python's lock held). The result does not depend on
        the tiling where the function uses no more than the points within `halo` of each. columns: that the function gets beside x, y, z and
        classification; by default all. after: type of the stage that it comes behind; by default the last ground filter, and where there is
        none the last reader or stage on flight lines. What it raises ends the run. A run with on_tile does not take up what an earlier one
        has done with it. progress: a line or bar on standard error.

        Raises Error; a limit of quality in the config that was missed is no error: Report.missed.
        """
        request = self._request() | {"bar": progress, "command": repr(self)}
        if on_tile is not None:
            request["on_tile"] = {"function": _on_tile(on_tile), "halo": halo, "columns": None if columns is None else list(columns),
                                  "after": after or "", "code": _code_of(on_tile)}
        done = _swath.run(request)
        return report_of(json.loads(done["report"]))
