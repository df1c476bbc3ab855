# SPDX-License-Identifier: GPL-3.0-or-later
"""Columns by LAS names: their types, and how they become those of a run and come back."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from . import _swath
from ._errors import Error, usage_error

Array = np.ndarray[Any, np.dtype[Any]]

# Fields of LAS and their types in memory; scan_angle in degrees.
LAS_TYPES: dict[str, np.dtype[Any]] = {name: np.dtype(kind) for name, kind in _swath.las_columns}
# Bits of the column flags that have names of their own.
FLAG_BITS = {"synthetic": 0, "key_point": 1, "withheld": 2, "overlap": 3}
# Extra fields with the columns of a run, and the unit of the former in that of the latter.
EXTRA_COLUMNS = {
    "range": ("range", 1.0), "incidence": ("incidence", np.pi / 180), "sigma_h": ("sigma_h", 1.0), "sigma_v": ("sigma_v", 1.0),
    "height_above_ground": ("height", 1.0), "ground_probability": ("ground_probability", 1.0),
}
SAME_NAMES = ("x", "y", "z", "intensity", "return_number", "classification", "user_data", "red", "green", "blue")
RENAMED = {"number_of_returns": "return_count", "point_source_id": "strip"}
# Bits of a run's flags that LAS has no place for: returns repaired, returns inconsistent, range gate, isolated, low point.
OWN_FLAGS = "swath_flags"
OWN_FLAG_MASK = 0x1F00
ADJUSTED = 1e9  # adjusted standard GPS time = GPS seconds less this
LEGACY_OVERLAP = 12  # class of formats 0 to 5 that stands for the flag


def nearest(word: str, candidates: Iterable[str]) -> str:
    """The hint that names the candidate nearest to a word; empty where none is near."""
    near = difflib.get_close_matches(word, list(candidates), 1)
    return f"did you mean '{near[0]}'?" if near else ""


def as_column(name: str, values: Any, dtype: np.dtype[Any] | None = None) -> Array:
    """Values as a contiguous column of the type. Raises Error where one of them does not fit it."""
    given = np.asarray(values)
    if given.dtype.kind not in "buif":
        raise usage_error(f"holds {given.dtype}, not numbers", name)
    if given.ndim == 0 or (given.ndim > 1 and name in LAS_TYPES) or given.ndim > 2:
        raise usage_error(f"has {given.ndim} dimensions; a column has one", name)
    if given.dtype.kind == "b":
        given = given.astype(np.uint8)
    if given.dtype == np.float16 or given.dtype.itemsize > 8:
        raise usage_error(f"numbers of type {given.dtype} have no field in LAS", name, "convert them to float32 or float64")
    wanted = dtype or LAS_TYPES.get(name) or given.dtype.newbyteorder("=")
    if given.dtype == wanted:
        return np.ascontiguousarray(given)
    with np.errstate(invalid="ignore", over="ignore"):
        made = given.astype(wanted)
    if wanted.kind in "ui":
        wrong = np.flatnonzero(made != given)
        if len(wrong):
            raise Error(f"{given[wrong[0]]} does not fit {wanted}", f"{name}: row {wrong[0]}", "round or clip the values first")
    return np.ascontiguousarray(made)


def expect_finite(columns: Mapping[str, Array]) -> None:
    """Raises Error where a coordinate is not a number."""
    for name in "xyz":
        wrong = np.flatnonzero(~np.isfinite(columns[name]))
        if len(wrong):
            raise Error(f"{columns[name][wrong[0]]} is not a coordinate", f"{name}: row {wrong[0]}", "leave such points out")


def run_columns(columns: Mapping[str, Array], adjusted: bool, point_format: int) -> dict[str, Array]:
    """The columns of a run. Those of the same type are handed on as they are."""
    out = {name: columns[name] for name in SAME_NAMES if name in columns}
    out |= {to: columns[name] for name, to in RENAMED.items() if name in columns}
    for name, (to, factor) in EXTRA_COLUMNS.items():
        if name in columns and columns[name].ndim == 1:
            out[to] = np.ascontiguousarray(columns[name] * factor, np.float32) if factor != 1 else as_column(name, columns[name], np.dtype("f4"))
    if "gps_time" in columns:
        out["time"] = columns["gps_time"] + ADJUSTED if adjusted else columns["gps_time"]
    if "scan_angle" in columns:
        out["scan_angle"] = np.radians(columns["scan_angle"]).astype(np.float32)
    flags = np.zeros(len(columns["x"]), np.uint16)
    for name, shift in (("flags", 0), ("scan_direction_flag", 4), ("edge_of_flight_line", 5), (OWN_FLAGS, 0)):
        if name in columns:
            flags |= columns[name].astype(np.uint16) << shift
    if point_format < 6 and "classification" in columns:
        overlap = columns["classification"] == LEGACY_OVERLAP
        flags[overlap] |= 1 << FLAG_BITS["overlap"]
        out["classification"] = np.where(overlap, np.uint8(1), columns["classification"])
    out["flags"] = flags
    return out


def las_columns(taken: Mapping[str, Array], before: Mapping[str, Array], adjusted: bool, point_format: int) -> dict[str, Any]:
    """A run's columns by LAS names. `before`: the columns that the points had."""
    out: dict[str, Array] = {}
    for name, values in taken.items():
        if name == "flags":
            out["flags"] = (values & 0xF).astype(np.uint8)
            out["scan_direction_flag"] = (values >> 4 & 1).astype(np.uint8)
            out["edge_of_flight_line"] = (values >> 5 & 1).astype(np.uint8)
            own = values & OWN_FLAG_MASK
            if own.any() or OWN_FLAGS in before:
                out[OWN_FLAGS] = own
        elif name == "time":
            out["gps_time"] = values - ADJUSTED if adjusted else values
        elif name == "scan_angle":
            out["scan_angle"] = np.degrees(values).astype(np.float32)
        elif name in SAME_NAMES:
            out[name] = values
        else:
            for las, run in RENAMED.items():
                if run == name:
                    out[las] = values
            for extra, (run, factor) in EXTRA_COLUMNS.items():
                if run == name:
                    out[extra] = (values / factor).astype(np.float32) if factor != 1 else values
    if point_format < 6 and "classification" in out and "classification" in before:
        stays = (before["classification"] == LEGACY_OVERLAP) & (out["classification"] == 1)
        if stays.any():
            out["classification"] = np.where(stays, np.uint8(LEGACY_OVERLAP), out["classification"])
    return out
