// SPDX-License-Identifier: GPL-3.0-or-later
// Thinning of the terrain's points to those that its surface needs.
#pragma once

#include <cstdint>
#include <vector>

#include "core/block.h"
#include "core/config/option.h"
#include "core/config/result.h"
#include "core/tile_columns.h"

namespace swath::terrain {

struct KeyPointOptions {
  core::Metres tolerance{0.1};
  core::Metres cell{100.0};
  core::Metres max_edge{60.0};
  std::vector<int> classes{core::point_class::ground};
};

template <class V>
void describe(KeyPointOptions& o, V& v) {
  v.option("tolerance", o.tolerance, core::above(0.0),
           "Maximum height from the triangulation of the key points; 0.1 m suits contours of 0.5 m.", "Heller1990");
  v.option("cell", o.cell, core::above(0.0), "Side of the squares thinned separately; border points are kept, so small squares keep more.");
  v.option("max_edge", o.max_edge, core::above(0.0), "As in terrain.dtm: no gap wider than this is bridged, before or after.");
  v.option("classes", o.classes, core::within(0, 255), "ASPRS classes that are terrain.");
}

struct KeyPointCounts {
  std::uint64_t terrain = 0;  ///< of the own points
  core::Flagged key;          ///< of these
  double farthest = 0.0;      ///< m: largest distance in height of a point that was left out
};

template <class V>
void describe(const KeyPointCounts& r, V& v) {
  v.result("ground points", r.terrain, "Points of the terrain.");
  v.result("key points", r.key, "Of those: points that the terrain needs.");
}

/// The columns that it works with.
inline core::TileColumns columns(const KeyPointOptions&) {
  using core::Column;
  return {.needs = {Column::classification, Column::flags}, .reads = {}, .gives = {Column::flags}};
}

/// Width of the border of points around the own ones, m.
double halo(const KeyPointOptions& options);

/// Sets the key-point flag of those of the first `own` points that the terrain needs and clears it on all others. The Delaunay
/// triangulation of the flagged points, circumradius at most max_edge / 2, covers what that of all terrain points covers, and passes each
/// of them within the tolerance (of points at one place the lowest counts). The answer is the same for every tiling (proof in the source).
KeyPointCounts mark_key_points(core::Block& block, std::size_t own, const KeyPointOptions& options);

}  // namespace swath::terrain
