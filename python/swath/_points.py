# SPDX-License-Identifier: GPL-3.0-or-later
"""Point clouds as NumPy columns by LAS names."""

from __future__ import annotations

import glob
import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from . import _swath
from ._columns import FLAG_BITS, LAS_TYPES, Array, as_column, expect_finite, nearest
from ._errors import Error, usage_error

PathLike = str | os.PathLike[str]
# LAS's numbers of the types of extra fields.
EXTRA_TYPES = {"u1": 1, "i1": 2, "u2": 3, "i2": 4, "u4": 5, "i4": 6, "u8": 7, "i8": 8, "f4": 9, "f8": 10}
WAVE_COLUMNS = ("wavepacket_index", "wavepacket_offset", "wavepacket_size", "return_point_wave_location", "x_t", "y_t", "z_t")


@dataclass(frozen=True)
class Storage:
    """How points are stored in a file: from the file that they came from, or as write_points() would choose.

    scale, offset: of the integers that hold x, y, z. point_format: of LAS, 0 to 10. adjusted: times are adjusted standard GPS time, otherwise
    seconds of the GPS week. extras: LAS's declarations of extra fields.
    """

    scale: tuple[float, float, float] = (0.001, 0.001, 0.001)
    offset: tuple[float, float, float] | None = None
    point_format: int | None = None
    adjusted: bool = True
    file_source_id: int = 0
    extras: tuple[Mapping[str, Any], ...] = ()


@dataclass(frozen=True, repr=False, eq=False)
class Points:
    """Points as columns by LAS names: read-only NumPy arrays of one length, points["intensity"] or points.intensity.

    Columns of one Points may be shared with another: with_columns() makes a new one with some of them replaced. x, y, z are float64 in
    units of the CRS, gps_time is float64 as stored, scan_angle float32 in degrees; extra fields keep their names and types. Names of flags
    (withheld, key_point, synthetic, overlap) and X, Y, Z (the stored integers) are made when asked for. A mask, slice or index array gives
    the Points of its rows.
    """

    columns: dict[str, Array]
    crs: str = ""
    storage: Storage = field(default_factory=Storage)
    counts: dict[str, int] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        sizes = {name: len(c) for name, c in self.columns.items()}
        if len(set(sizes.values())) > 1:
            raise usage_error(f"columns of different length: {sizes}", "Points")

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the columns."""
        return tuple(self.columns)

    @property
    def size(self) -> int:
        """Number of points."""
        return len(next(iter(self.columns.values()))) if self.columns else 0

    def __len__(self) -> int:
        return self.size

    def __contains__(self, name: object) -> bool:
        return name in self.columns

    def __getitem__(self, name: Any) -> Any:
        if not isinstance(name, str):
            return replace(self, columns={n: np.ascontiguousarray(c[name]) for n, c in self.columns.items()})
        if name in self.columns:
            return self.columns[name]
        if name in FLAG_BITS and "flags" in self.columns:
            return self.columns["flags"] >> FLAG_BITS[name] & np.uint8(1)
        if name in ("X", "Y", "Z") and name.lower() in self.columns:
            axis = "XYZ".index(name)
            return np.round((self.columns[name.lower()] - self._offset()[axis]) / self.storage.scale[axis]).astype(np.int32)
        raise usage_error(f"no column is named '{name}'", "Points", nearest(name, self.columns) or "columns: " + ", ".join(self.columns))

    def __getattr__(self, name: str) -> Array:
        if name.startswith("_") or (name not in self.__dict__.get("columns", ()) and name not in FLAG_BITS):
            raise AttributeError(name)
        column: Array = self[name]
        return column

    def __repr__(self) -> str:
        return f"<swath.Points: {self.size} points, {', '.join(self.columns)}; crs {self.crs[:40] or 'not stated'}>"

    def _offset(self) -> tuple[float, float, float]:
        if self.storage.offset is not None:
            return self.storage.offset
        if self.size == 0:
            return (0.0, 0.0, 0.0)
        step = 1e5  # with 0.001 the 32 bits reach 2147 km to either side
        return (float(np.round(self.columns["x"][0] / step) * step), float(np.round(self.columns["y"][0] / step) * step), 0.0)

    @property
    def array(self) -> Array:
        """A structured array by LAS names, a copy: one field per column, and one for each flag in place of flags."""
        fields: dict[str, Array] = {}
        for name, column in self.columns.items():
            fields |= {flag: self[flag] for flag in FLAG_BITS} if name == "flags" else {name: column}
        out = np.empty(self.size, [(n, c.dtype, c.shape[1:]) for n, c in fields.items()])
        for name, column in fields.items():
            out[name] = column
        return out

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> Array:
        if copy is False:
            raise ValueError("a structured array of columns is a copy")
        return self.array if dtype is None else self.array.astype(dtype)

    def with_columns(self, crs: str | None = None, **columns: Any) -> Points:
        """New Points with these columns added or replaced; the others are shared. None removes a column."""
        made = dict(self.columns)
        for name, values in columns.items():
            if values is None:
                made.pop(name, None)
            elif name in FLAG_BITS:
                bit = np.uint8(1 << FLAG_BITS[name])
                flags = made.get("flags", np.zeros(self.size, np.uint8)) & ~bit
                made["flags"] = flags | np.where(np.asarray(values, bool), bit, np.uint8(0))
            else:
                made[name] = as_column(name, values)
        extras = tuple(e for e in self.storage.extras if columns.get(e["name"]) is None)
        return replace(self, columns=made, crs=self.crs if crs is None else crs, storage=replace(self.storage, extras=extras))

    # Arrow, https://arrow.apache.org/docs/format/CDataInterface/PyCapsuleInterface.html: a struct with a field per column, without copies.
    def __arrow_c_schema__(self) -> Any:
        return _swath.arrow_schema(self.columns)

    def __arrow_c_array__(self, requested_schema: Any = None) -> Any:
        return _swath.arrow_array(self.columns)

    def __arrow_c_stream__(self, requested_schema: Any = None) -> Any:
        return _swath.arrow_stream(self.columns)

    def write(self, path: PathLike, **how: Any) -> None:
        """As write_points()."""
        write_points(self, path, **how)


def as_points(given: Any, crs: str | None = None) -> Points:
    """Points of anything with columns: Points, a structured array, a mapping of names to arrays. Columns of the right type are not copied."""
    if isinstance(given, Points):
        return given if crs is None else replace(given, crs=crs)
    if isinstance(given, np.ndarray):
        if given.dtype.names is None or given.ndim != 1:
            raise usage_error("is not a structured array of one dimension", "points", "its fields are x, y, z and other names of LAS")
        given = {name: given[name] for name in given.dtype.names}
    if not isinstance(given, Mapping):
        raise usage_error(f"a {type(given).__name__} has no columns", "points", "give Points, a structured array, or a dict of arrays")
    flags = {name: values for name, values in given.items() if name in FLAG_BITS}
    columns = {name: as_column(name, values) for name, values in given.items() if name not in FLAG_BITS and name not in ("X", "Y", "Z")}
    for name in "xyz":
        if name not in columns:
            raise usage_error(f"no column '{name}'", "points", nearest(name, given))
    made = Points(columns, crs or "")
    return made.with_columns(**flags) if flags else made


def _files(path: PathLike | Sequence[PathLike]) -> list[str]:
    out: list[str] = []
    for one in [path] if isinstance(path, (str, os.PathLike)) else path:
        name = os.fspath(one)
        found = sorted(glob.glob(name)) if any(c in name for c in "*?[") and not os.path.exists(name) else [name]
        if not found:
            raise usage_error("no file has such a name", name)
        out += found
    if not out:
        raise usage_error("no file was named", "read_points")
    return out


def read_points(path: PathLike | Sequence[PathLike], *, columns: Sequence[str] | None = None, crs: str | None = None,
                threads: int = 0) -> Points:
    """Reads LAS and LAZ files (COPC with them) as columns; nothing is copied between the reader and NumPy.

    path: a file, a pattern (*.laz), or several of them, read one after the other. columns: these alone, beside x, y, z: the others take no
    memory. crs: in place of what the files state. threads: for LAZ; 0 one per processor. Raises Error for a file that cannot be read, and
    where files differ in CRS, time scale or the type of an extra field.
    """
    wanted = None if columns is None else ["x", "y", "z", *columns]
    made, text = _swath.read_points(_files(path), wanted, threads)
    about = json.loads(text)
    for name in columns or ():
        if name not in made:
            raise usage_error(f"the files have no field '{name}'", "columns", nearest(name, [*LAS_TYPES, *(e["name"] for e in about["extras"])]))
    storage = Storage(tuple(about["scale"]), tuple(about["offset"]), about["point_format"], about["adjusted"], about["file_source_id"],
                      tuple(about["extras"]))
    return Points(made, about["crs"] if crs is None else crs, storage, warnings=tuple(about["warnings"]))


def _format_of(columns: Mapping[str, Array]) -> int:
    wave = any(name in columns for name in WAVE_COLUMNS)
    if "nir" in columns:
        return 10 if wave else 8
    return 9 if wave else 7 if "red" in columns else 6


def _extra(name: str, column: Array, known: Mapping[str, Mapping[str, Any]]) -> Mapping[str, Any]:
    """LAS's declaration of an extra field: that of the file it came from where it still fits."""
    per_row = column.shape[1] if column.ndim == 2 else 1
    if name in known:
        e = known[name]
        numbers = e["type"] in range(1, 11) and ("scale" in e or "nodata" in e)
        if numbers == (column.dtype == np.float64 and per_row == 1) or not numbers:
            return e
    kind = column.dtype.str[1:]
    if kind not in EXTRA_TYPES:
        raise usage_error(f"numbers of type {column.dtype} have no field in LAS", name)
    if len(name.encode()) > 32:
        raise usage_error("the name is longer than the 32 bytes that LAS has for it", name)
    if per_row > 3:
        if kind != "u1":
            raise usage_error(f"{per_row} numbers to a point; LAS has up to 3", name)
        return {"name": name, "description": "", "type": 0, "bytes": per_row}
    return {"name": name, "description": "", "type": EXTRA_TYPES[kind] + 10 * (per_row - 1), "bytes": 0}


def write_points(points: Any, path: PathLike, crs: str | None = None, *, scale: float | Sequence[float] | None = None,
                 offset: Sequence[float] | None = None, point_format: int | None = None, threads: int = 0) -> None:
    """Writes points as LAS 1.4, LAZ where the name ends in .laz. The file appears whole or not at all.

    points: Points, a structured array, or a mapping of names to arrays. Names of LAS fill its fields, other columns become extra fields of
    their own type. crs: EPSG code, WKT or PROJ text; otherwise that of the points. scale, offset: of the stored integers, units of the CRS;
    point_format: 0 to 10; by default those of the file that the points came from, or 0.001, near the first point, and the smallest of
    6 to 10 that holds all columns. Coordinates are rounded to multiples of the scale; all else is exact. Raises Error naming column and row
    for a value that its field cannot hold.
    """
    made = as_points(points, crs)
    expect_finite(made.columns)
    used = point_format if point_format is not None else made.storage.point_format
    used = _format_of(made.columns) if used is None else used
    if not 0 <= used <= 10:
        raise usage_error(f"{used} is not a point format of LAS", "point_format", "0 to 10")
    steps = made.storage.scale if scale is None else (float(scale),) * 3 if isinstance(scale, (int, float)) else tuple(map(float, scale))
    if scale is not None and (len(steps) != 3 or not all(np.isfinite(s) and s > 0 for s in steps)):
        raise usage_error(f"{scale} is not a scale", "scale", "a number above 0, or one for each of x, y, z")
    known = {e["name"]: e for e in made.storage.extras}
    extras = [_extra(n, c, known) for n, c in made.columns.items() if n not in LAS_TYPES]
    columns = dict(made.columns)
    for e in extras:
        if e["type"] in range(1, 11) and ("scale" in e or "nodata" in e):
            columns[e["name"]] = as_column(e["name"], columns[e["name"]], np.dtype("f8"))
    about = {"scale": steps, "offset": list(made._offset() if offset is None else map(float, offset)), "point_format": used,
             "adjusted": made.storage.adjusted, "file_source_id": made.storage.file_source_id, "extras": extras}
    if Path(path).suffix.lower() not in (".las", ".laz"):
        raise usage_error("the name of a point file ends in .las or .laz", os.fspath(path))
    _swath.write_points(os.fspath(path), columns, json.dumps(about), made.crs, threads)


__all__ = ["Error", "Points", "Storage", "as_points", "read_points", "write_points"]
