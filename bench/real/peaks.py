# SPDX-License-Identifier: GPL-3.0-or-later
"""Ground points that stand alone high above all ground around them: what single returns from roofs make of a terrain model."""
import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import Delaunay

LEVEL, SLOPE, NEAR = 0.3, 0.3, 10.0  # m, m per m, m: neighbours within this are of one group
LARGEST = 4                         # points of a group
FALL = 1.5                          # m: to each neighbour outside of it


def peaks(x, y, z, ground):
    """Rows of the points of such groups in the TIN of the ground points, a list per group; each group's mean fall, m."""
    rows = np.flatnonzero(ground)
    places = np.column_stack([x - np.mean(x), y - np.mean(y)])[rows]
    rows = rows[np.unique(np.round(places, 2), axis=0, return_index=True)[1]]
    if len(rows) < 4:
        return [], np.array([])
    places, height = np.column_stack([x - np.mean(x), y - np.mean(y)])[rows], z[rows]
    begin, to = Delaunay(places).vertex_neighbor_vertices
    at = np.repeat(np.arange(len(rows)), np.diff(begin))
    run, fall = np.hypot(*(places[at] - places[to]).T), height[at] - height[to]
    linked = (np.abs(fall) <= LEVEL + SLOPE * run) & (run <= NEAR)
    count, group = connected_components(coo_matrix((np.ones(linked.sum()), (at[linked], to[linked])), shape=(len(rows),) * 2), directed=False)
    leaves = group[at] != group[to]
    edges, least = np.bincount(group[at[leaves]], minlength=count), np.full(count, np.inf)
    np.minimum.at(least, group[at[leaves]], fall[leaves])
    mean = np.bincount(group[at[leaves]], weights=fall[leaves], minlength=count) / np.maximum(edges, 1)
    found = np.flatnonzero((np.bincount(group) <= LARGEST) & (edges > 0) & (least > FALL))
    return [rows[group == k] for k in found], mean[found]
