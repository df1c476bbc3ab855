# SPDX-License-Identifier: GPL-3.0-or-later
"""Every stage on points as a function. Names, options and texts are those that the stages declare; the stubs are made of them, too."""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Mapping
from typing import Any

from ._runs import GIVERS, declared, run_on_points

# Stages that need more than points and a trajectory: files that a survey names.
NOT_ON_POINTS = ("terrain.breaklines", "terrain.penetration")
SETTINGS_DOC = """threads: 0 one per processor. memory: of the whole process, "4 GB"; by default 2 GB beside what it holds. tile: side of the
    tiles that are worked on at once, "500 m". progress: a line or bar on standard error."""


def short_name(stage: str) -> str:
    return stage.split(".")[1]


def stages_on_points() -> list[dict[str, Any]]:
    """The declared stages that become functions."""
    return [d for name, d in declared().items()
            if name.split(".")[0] in ("filters", "terrain") and name not in NOT_ON_POINTS and (d["gives"] or d["gives_products"])]


def givers_of(d: Mapping[str, Any]) -> list[str]:
    """Short names of the stages that come before where the points lack what they give."""
    out: list[str] = []
    for needed in [*d["needs_products"], *d["needs"]]:
        if needed in GIVERS:
            out += [n for n in [*givers_of(declared()[GIVERS[needed]]), short_name(GIVERS[needed])] if n not in out]
    return out


def needs_trajectory(d: Mapping[str, Any]) -> bool:
    return "trajectory" in d["needs_products"]


def options_of(d: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Options at the top: those of tables are given as a dict."""
    return [o for o in d["options"] if "." not in o["path"] and not o["path"].endswith("[]")]


def result_type(d: Mapping[str, Any]) -> str:
    grids = [p for p in d["gives_products"] if p not in ("contours", "points")]
    parts = ["Points"] if d["gives"] else []
    if grids:
        parts.append("Grid" if len(grids) == 1 else "dict[str, Grid]")
    if "contours" in d["gives_products"]:
        parts.append("Contours")
    return parts[0] if len(parts) == 1 else f"tuple[{', '.join(parts)}]"


def _option_doc(o: Mapping[str, Any]) -> str:
    notes = [n for n in (o["shape"], o["range"], f"default {o['default']}" if o["default"] else "") if n]
    source = f" [{o['source']}]" if o["source"] else ""
    text = f"{o['path']}: {o['doc']}{source}" + ("" if o["is_table"] else f" ({', '.join(notes)})")
    return textwrap.fill(text, 140, initial_indent="    ", subsequent_indent="        ")


def docstring(d: Mapping[str, Any]) -> str:
    """Of a function, from what its stage declares."""
    gives = {"Points": "Points with the columns " + ", ".join(d["gives"]) + " added or replaced; `counts` of them says what was done",
             "Grid": "a Grid", "Contours": "Contours"}.get(result_type(d), "grids by name" if "tuple" not in result_type(d) else "points and grids")
    lines = [d["summary"], "", f"    The stage {d['name']}. Returns {gives}.", ""]
    lines += ["    points: Points, a structured array, or a mapping of names to arrays; without a CRS a map in metres is taken."]
    lines += [_option_doc(o) for o in options_of(d)]
    lines += [f"    {n}: options of {n}, which comes before where it is needed." for n in givers_of(d)]
    if needs_trajectory(d):
        lines += ["    trajectory: of the flight, from smooth() or read_trajectory()."]
    lines += [f"    survey: keys of survey.toml that the stage reads, as a dict. {SETTINGS_DOC}", ""]
    counted = [f"{c['key']}: {c['doc']}" for c in d["counts"]]
    lines += ["    Counts:", *[textwrap.fill(c, 140, initial_indent="    ", subsequent_indent="        ") for c in counted], ""] if counted else []
    lines += ["    Raises Error for an unknown option (naming the nearest), a value out of range or without its unit, and points that do not fit.", "    "]
    return "\n".join(lines)


def _made(d: Mapping[str, Any]) -> Callable[..., Any]:
    givers = givers_of(d)

    def function(points: Any, /, *, trajectory: Any = None, survey: Mapping[str, Any] | None = None, threads: int | None = None,
                 memory: str | None = None, tile: str | None = None, progress: bool = False, **options: Any) -> Any:
        others = {n: options.pop(n) for n in givers if n in options}
        own = {k: v for k, v in options.items() if v is not None}
        return run_on_points(f"swath.{short_name(d['name'])}", points, d["name"], own, others=others, trajectory=trajectory, survey=survey or {},
                             settings={"threads": threads, "memory": memory, "tile": tile}, bar=progress)

    function.__name__ = function.__qualname__ = short_name(d["name"])
    function.__module__ = "swath"
    function.__doc__ = docstring(d)
    return function


FUNCTIONS: dict[str, Callable[..., Any]] = {short_name(d["name"]): _made(d) for d in stages_on_points()}
