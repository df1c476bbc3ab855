# SPDX-License-Identifier: GPL-3.0-or-later
"""The labelled clouds of the reference data: what is judged in each, and how the program's points find their labels again."""
import sys
from dataclasses import dataclass, field
from pathlib import Path

import laspy
import numpy as np
from scipy import ndimage, spatial

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "accuracy"))
import common


@dataclass
class Cloud:
    name: str
    file: str
    crs: str
    ground: tuple = (2,)
    ignored: tuple = ()  # classes that are neither ground nor surely something else: left out of the labels' tables
    building: tuple = ()
    bridge: tuple = ()
    water: tuple = ()
    origin: str = field(default="real")

    def read(self):
        return laspy.read(common.reference() / self.file)


ISPRS = [Cloud(f"isprs {n}", f"isprs/samp{n}-utm.las", "EPSG:32632") for n in (11, 21, 24, 41, 52, 54, 71)]
# Works of art (26) are decks and what carries them: no ground. Class 1 is what is neither ground, building nor water there: mostly vegetation.
AHN3 = [Cloud("ahn3 delft", "ahn3_delft/ahn3_cropped_1.laz", "EPSG:28992", building=(6,), bridge=(26,), water=(9,))]
# Classes 65 and 67 are artefacts; 64 is on facades. The rest of class 1 is not classified by the maker and judged as not ground.
IGN = [Cloud("ign 627760", "ign_lidarhd/test_data_77050_627760_LA93_IGN69.laz", "EPSG:2154", ignored=(65, 67), building=(6, 64)),
       Cloud("ign 627755", "ign_lidarhd/test_data_77055_627755_LA93_IGN69.laz", "EPSG:2154", ignored=(65, 67), building=(6, 64)),
       Cloud("ign farmland", "ign_lidarhd/las_with_several_extra_byte_bloc.laz", "EPSG:2154", ignored=(65, 67), building=(6,)),
       Cloud("ign thinned", "ign_lidarhd/test_semis_2021_0382_6565_LA93_IGN69_cropped.laz", "EPSG:2154", ignored=(65, 67), building=(6,), bridge=(17,), water=(9,))]
ALL = [*ISPRS, *AHN3, *IGN]


def named(words):
    return [c for c in ALL if not words or any(w in c.name for w in words)]


def copy_of(cloud, source, folder, classes):
    """Writes a copy with other classes, and a survey.toml beside it."""
    folder.mkdir(exist_ok=True)
    las = laspy.LasData(source.header, source.points.copy())
    las.classification = classes
    if las.header.point_format.id and len(las.points) and np.min(las.gps_time) > 604800:
        las.header.global_encoding.gps_time_type = laspy.header.GpsTimeType.STANDARD  # the makers left the bit out
    las.write(str(folder / "cloud.las"))
    (folder / "survey.toml").write_text(f'name = "{cloud.name}"\ncrs = "{cloud.crs}"\n[[points]]\nfile = "cloud.las"\ncrs = "{cloud.crs}"\n')


def order_of(points, source):
    """Rows of `points` in the order of the source's; equal places of one return number are interchangeable."""
    if len(points["x"]) != len(source.points):
        sys.exit(f"{len(points['x'])} points come back of {len(source.points)}")
    mm = [np.round(np.asarray(axis) * 1000).astype(np.int64) for axis in (source.x, source.y, source.z)]
    mine = [np.round(points[axis] * 1000).astype(np.int64) for axis in "xyz"]
    numbers = np.asarray(source.return_number).astype(int), points["return_number"].astype(int)
    theirs_sorted = np.lexsort((numbers[0], *mm))
    mine_sorted = np.lexsort((numbers[1], *mine))
    if any((a[theirs_sorted] != b[mine_sorted]).any() for a, b in zip(mm, mine)):
        sys.exit("a point has moved by more than 0.5 mm")
    order = np.empty(len(mine_sorted), np.int64)
    order[theirs_sorted] = mine_sorted
    return order


class Rim:
    """Distance to the outside of the data, m; voids inside narrower than `gap` are no outside."""

    def __init__(self, x, y, cell=1.0, gap=12.0):
        places = np.column_stack([x, y])
        apart = spatial.cKDTree(places).query(places[:: max(1, len(x) // 5000)], k=2)[0][:, 1]
        gap = max(gap, 6 * np.median(apart))
        wide = 2 * int(np.ceil(gap / cell))
        self.x0, self.y0, self.cell = x.min() - wide * cell, y.min() - wide * cell, cell
        i, j = self.cells(x, y)
        held = np.zeros((j.max() + 1 + wide, i.max() + 1 + wide), bool)
        held[j, i] = True
        near = ndimage.distance_transform_edt(~held) * cell <= gap / 2
        inside = ndimage.distance_transform_edt(near) * cell > gap / 2
        self.distance = ndimage.distance_transform_edt(ndimage.binary_fill_holes(inside)) * cell

    def cells(self, x, y):
        return ((x - self.x0) / self.cell).astype(int), ((y - self.y0) / self.cell).astype(int)

    def __call__(self, x, y):
        i, j = self.cells(x, y)
        within = (i >= 0) & (j >= 0) & (i < self.distance.shape[1]) & (j < self.distance.shape[0])
        return np.where(within, self.distance[np.where(within, j, 0), np.where(within, i, 0)], 0.0)
