# SPDX-License-Identifier: GPL-3.0-or-later
"""Grids and contours in memory, and as files for rasterio, xarray, geopandas and GIS."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from . import _swath
from ._columns import Array
from ._errors import Error, usage_error

# Why a cell has no height: values of Grid.void_reason.
VOIDS = ("height known", "no data", "edge too long", "water", "never seen")


@dataclass(frozen=True, repr=False, eq=False)
class Grid:
    """A surface on square cells, rows from the north as rasters have them.

    height: float32, rows x columns, NaN where there is none; in units of the CRS's heights (for other grids than heights: of the grid, see
    docs/stages). sigma: standard deviation of each height, or None. count: points in each cell, or None. void_reason: index of VOIDS for each
    cell, or None. cell: side of a cell; west, north: upper left corner, all in units of the CRS.
    """

    height: Array
    cell: float
    west: float
    north: float
    crs: str = ""
    name: str = "height"
    sigma: Array | None = None
    count: Array | None = None
    void_reason: Array | None = None
    counts: dict[str, int] = field(default_factory=dict)

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        rows, columns = self.height.shape
        return rows, columns

    @property
    def transform(self) -> tuple[float, float, float, float, float, float]:
        """The affine (a, b, c, d, e, f) of rasterio and affine: x = a column + b row + c, y = d column + e row + f, of a cell's corner."""
        return (self.cell, 0.0, self.west, 0.0, -self.cell, self.north)

    @property
    def x(self) -> Array:
        """Eastings of the columns' centres."""
        return self.west + (np.arange(self.shape[1]) + 0.5) * self.cell

    @property
    def y(self) -> Array:
        """Northings of the rows' centres, from the north."""
        return self.north - (np.arange(self.shape[0]) + 0.5) * self.cell

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> Array:
        return self.height if dtype is None else self.height.astype(dtype)

    def __repr__(self) -> str:
        return f"<swath.Grid {self.name}: {self.shape[0]} x {self.shape[1]} cells of {self.cell:g}, {int(np.isfinite(self.height).sum())} known>"

    def at(self, x: Any, y: Any) -> Array:
        """Heights of the cells that hold the places x, y (units of the CRS); NaN outside."""
        column = np.floor((np.asarray(x, float) - self.west) / self.cell)
        row = np.floor((self.north - np.asarray(y, float)) / self.cell)
        inside = (column >= 0) & (row >= 0) & (column < self.shape[1]) & (row < self.shape[0])
        out = np.full(np.broadcast(column, row).shape, np.nan, np.float32)
        out[inside] = self.height[row[inside].astype(int), column[inside].astype(int)]
        return out

    def write(self, path: str | os.PathLike[str]) -> None:
        """Writes a Cloud Optimized GeoTIFF: height, and sigma and count where they are there, as bands; no data is -9999.

        The corner must lie on whole multiples of the cell, as those of all grids made here do.
        """
        for corner in (self.west, self.north):
            if abs(corner / self.cell - round(corner / self.cell)) > 1e-3:
                raise usage_error(f"the corner {corner} is not on a multiple of the cell {self.cell}", os.fspath(path))
        bands = {self.name: self.height, "sigma": self.sigma, "count": self.count}
        there = {n: np.ascontiguousarray(b, np.float32) for n, b in bands.items() if b is not None}
        _swath.write_raster(os.fspath(path), list(there), list(there.values()), self.cell, self.west, self.north, "", self.crs)


def read_grid(path: str | os.PathLike[str], band: int = 1) -> Grid:
    """Reads one band (from 1) of a north-up raster of square cells that GDAL reads: GeoTIFF, VRT, ASCII grid and others."""
    values, g, crs, name, _, _ = _swath.read_raster(os.fspath(path), band)
    if g[2] or g[4] or abs(g[1] + g[5]) > 1e-9 * abs(g[1]):
        raise Error("its pixels are rotated or not square", os.fspath(path), "resample it, for example with gdalwarp")
    return Grid(values.astype(np.float32), g[1], g[0], g[3], crs, name or "height")


@dataclass(frozen=True, repr=False, eq=False)
class Contour:
    """One contour. x, y: its vertices, units of the CRS; a closed one repeats the first vertex. index: drawn thick. depression: round lower
    ground."""

    x: Array
    y: Array
    height: float
    index: bool = False
    closed: bool = False
    depression: bool = False


@dataclass(frozen=True, repr=False, eq=False)
class Contours(Sequence[Contour]):
    """Contour lines. geopandas.GeoDataFrame.from_features(contours, crs=contours.crs) and whatever else knows __geo_interface__ take them."""

    lines: tuple[Contour, ...]
    crs: str = ""
    counts: dict[str, int] = field(default_factory=dict)

    def __len__(self) -> int:
        return len(self.lines)

    def __getitem__(self, i: Any) -> Any:
        return self.lines[i]

    def __iter__(self) -> Iterator[Contour]:
        return iter(self.lines)

    def __repr__(self) -> str:
        heights = [line.height for line in self.lines]
        return f"<swath.Contours: {len(heights)} lines" + (f", {min(heights):g} to {max(heights):g}>" if heights else ">")

    @property
    def __geo_interface__(self) -> Mapping[str, Any]:
        """A FeatureCollection of LineStrings in the CRS of the contours."""
        return {"type": "FeatureCollection", "features": [
            {"type": "Feature", "geometry": {"type": "LineString", "coordinates": np.column_stack([c.x, c.y]).tolist()},
             "properties": {"height": c.height, "index": c.index, "closed": c.closed, "depression": c.depression}} for c in self.lines]}

    def write(self, path: str | os.PathLike[str]) -> None:
        """Writes GeoPackage (.gpkg), DXF (.dxf) or GeoJSON (.geojson: WGS 84, as its standard wants)."""
        if not self.crs:
            raise usage_error("contours without a CRS cannot be written", os.fspath(path), "make them of points whose crs is stated")
        _swath.write_contours(os.fspath(path), [(c.x, c.y, c.height, c.index, c.closed, c.depression) for c in self.lines], self.crs)
