# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs of stages on points in memory, in a temporary folder that goes with them."""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

from . import _swath
from ._columns import expect_finite, las_columns, nearest, run_columns
from ._errors import usage_error
from ._points import Points, as_points
from ._surfaces import Contour, Contours, Grid

# Points without a CRS are on a map of their own, in metres.
LOCAL = ('PROJCS["local map in metres",GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563]],PRIMEM["Greenwich",0],'
         'UNIT["degree",0.0174532925199433]],PROJECTION["Transverse_Mercator"],PARAMETER["latitude_of_origin",0],'
         'PARAMETER["central_meridian",0],PARAMETER["scale_factor",1],PARAMETER["false_easting",0],PARAMETER["false_northing",0],'
         'UNIT["metre",1]]')
MEMORY_BESIDE = 2e9  # bytes that a run may take beside what the process holds, where nothing is stated
# Columns and grids by the stage that gives them where a function needs them and the points have none.
GIVERS = {"height": "filters.hag_dem", "dtm": "terrain.dtm", "dsm": "terrain.dsm"}
RUN_SETTINGS = ("threads", "memory", "tile")


@cache
def declared() -> dict[str, dict[str, Any]]:
    """What every stage declares of itself, by name."""
    return {s["name"]: s for s in json.loads(_swath.stages())}


def plain(value: Any) -> Any:
    """An option's value as JSON has it."""
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if isinstance(value, Mapping):
        return {k: plain(v) for k, v in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(v) for v in value]
    if hasattr(value, "item") and getattr(value, "ndim", 1) == 0:
        return value.item()
    if not isinstance(value, (str, int, float, bool)):
        raise usage_error(f"a {type(value).__name__} is not the value of an option", "options", "texts with units, numbers, booleans or lists")
    return value


def run_table(settings: Mapping[str, Any], where: str) -> dict[str, Any]:
    """The table [run] of settings; those without a value are left out."""
    for name in settings:
        if name not in RUN_SETTINGS:
            raise usage_error(f"no setting is named '{name}'", where, nearest(name, RUN_SETTINGS))
    return {k: plain(v) for k, v in settings.items() if v is not None}


def with_givers(stages: Sequence[tuple[str, Mapping[str, Any]]], has: set[str], options: Mapping[str, Mapping[str, Any]]) -> list[tuple[str, Mapping[str, Any]]]:
    """The stages, each behind those that give what it needs. `options`: of these, by their short names."""
    out: list[tuple[str, Mapping[str, Any]]] = []
    for name, own in stages:
        d = declared()[name]
        for needed in [*d["needs_products"], *d["needs"]]:
            if needed not in has and needed in GIVERS:
                giver = GIVERS[needed]
                more = with_givers([(giver, options.get(giver.split(".")[1], {}))], has, options)
                out += more
        out.append((name, own))
        has |= {*d["gives_products"], *d["gives"]}
    return out


def grid_of(name: str, made: Mapping[str, Any], crs: str, counts: dict[str, int]) -> Grid:
    height = made["height"]
    if name in ("dtm", "dsm"):
        return Grid(height, made["cell"], made["west"], made["north"], crs, "height", made.get("sigma"), made.get("count"), made["void_reason"], counts)
    return Grid(height, made["cell"], made["west"], made["north"], crs, name, counts=counts)


def counts_of(report: Mapping[str, Any], stage: str) -> dict[str, int]:
    """What a stage counted, by the keys of report.json."""
    for s in report["stages"]:
        if s["type"] == stage:
            return {key: one["count"] for key, one in s.get("tally", {}).items()}
    return {}


def survey_file(folder: Path, survey: Mapping[str, Any]) -> str:
    file = folder / "survey.json"
    file.write_text(json.dumps(survey), encoding="utf-8")
    return str(file)


def run_on_points(where: str, given: Any, stage: str, options: Mapping[str, Any], *, settings: Mapping[str, Any],
                  others: Mapping[str, Mapping[str, Any]], trajectory: Any, survey: Mapping[str, Any], bar: bool) -> Any:
    """Runs one stage, and those that give what it needs, on points. What it gives: Points, a Grid, grids by name, Contours."""
    points = as_points(given)
    if points.size == 0:
        raise usage_error("there are no points", where)
    expect_finite(points.columns)
    _swath.check_options(stage, json.dumps(plain(options)), where)
    d = declared()[stage]
    adjusted = points.storage.adjusted
    form = 6 if points.storage.point_format is None else points.storage.point_format
    columns = run_columns(points.columns, adjusted, form)
    chain = with_givers([(stage, plain(options))], {"points", "trajectory", *columns, "record", "classification", "return_number", "return_count",
                                                    "intensity", "time", "strip", "scan_angle"}, plain(others))
    first: list[tuple[str, Mapping[str, Any]]] = [("python.trajectory", {})] if trajectory is not None else []
    grids = [p for p in d["gives_products"] if p not in ("contours", "breaklines", "points")]
    tree = {"run": run_table(settings, where),
            "stage": [{"type": name, **own} for name, own in [*first, ("python.points", {}), *chain, ("python.take", {})]]}
    request: dict[str, Any] = {
        "in_memory": True, "config": where, "tree": json.dumps(tree), "command": where, "points": columns, "weekless": not adjusted,
        "take_columns": d["gives"], "take_grids": grids, "take_lines": "contours.gpkg" if "contours" in d["gives_products"] else "", "bar": bar,
        "memory_beside": 0.0 if settings.get("memory") else MEMORY_BESIDE}
    if trajectory is not None:
        request |= {"trajectory": trajectory.held, "max_gap": trajectory.max_gap}
    with tempfile.TemporaryDirectory(prefix="swath-") as name:
        folder = Path(name)
        request |= {"survey": survey_file(folder, {"name": where, **survey, "crs": points.crs or LOCAL}), "output": str(folder / "out")}
        done = _swath.run(request)
    return _result(points, d, done, counts_of(json.loads(done["report"]), stage))


def _result(points: Points, d: Mapping[str, Any], done: Mapping[str, Any], counts: dict[str, int]) -> Any:
    parts: list[Any] = []
    if d["gives"]:
        form = 6 if points.storage.point_format is None else points.storage.point_format
        taken = {n: c for n, c in done["columns"].items() if n != "reached"}
        made = points.with_columns(**las_columns(taken, points.columns, points.storage.adjusted, form))
        parts.append(Points(made.columns, made.crs, made.storage, counts, points.warnings))
    grids = {name: grid_of(name, g, points.crs, counts) for name, g in done["grids"].items()}
    if grids:
        parts.append(next(iter(grids.values())) if len(grids) == 1 else grids)
    if "contours" in d["gives_products"]:
        lines = (Contour(c["x"], c["y"], c["height"], c["index"], c["closed"], c["depression"]) for c in done["lines"])
        parts.append(Contours(tuple(lines), points.crs, counts))
    return parts[0] if len(parts) == 1 else tuple(parts)
