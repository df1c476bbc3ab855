// SPDX-License-Identifier: GPL-3.0-or-later
// Terrain model: the TIN of the ground points, read at the cell centres.
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "core/block.h"
#include "core/config/option.h"
#include "core/grid.h"
#include "terrain/tin/tin.h"
#include "terrain/water/breaklines.h"

namespace swath::terrain {

enum class Interpolation {
  linear,             ///< the plane of the triangle
  natural_neighbour,  ///< Sibson's coordinates
};

struct DtmOptions {
  core::Metres cell{1.0};
  core::Metres max_edge{60.0};
  core::Metres smoothing{2.5};
  Interpolation interpolation = Interpolation::linear;
  std::vector<int> classes{core::point_class::ground};
  bool key_points = false;
  double correlation = 0.05;
  double unknown_bend = 0.1;
  std::optional<core::Metres> assumed_sigma, assumed_horizontal;
};

/// Those of the surface, without what its sigmas take for granted.
template <class V>
void describe_surface(DtmOptions& o, V& v) {
  v.option("cell", o.cell, core::above(0.0), "Side of one cell.");
  v.option("max_edge", o.max_edge, core::above(0.0),
           "Longest triangle bridged: largest diameter of its circumcircle, so no longer edge or wider gap.");
  v.option("smoothing", o.smoothing, core::within(0.0, 20.0),
           "Distance over which neighbours average random errors, breaks kept; 0: through every point.",
           "Jones2003, with planes judged by their misfit");
  v.option("interpolation", o.interpolation, "Between the points: linear on the triangles, or natural_neighbour, smooth but at the points.",
           "Sibson1981");
  v.option("classes", o.classes, core::within(0, 255), "ASPRS classes that are terrain.");
  v.option("key_points", o.key_points, "Only the points that filters.key_points has flagged.");
  v.option("correlation", o.correlation, core::within(0.0, 1.0),
           "Minimum share of a point's height variance that its neighbours share (trajectory, boresight).");
  v.option("unknown_bend", o.unknown_bend, core::at_least(0.0),
           "Change of slope (rise / run) assumed within a triangle where too few are around to estimate it.");
  v.check(o.max_edge >= o.cell, "max_edge must span at least one cell");
}

template <class V>
void describe(DtmOptions& o, V& v) {
  describe_surface(o, v);
  v.option("assumed_sigma", o.assumed_sigma, core::within(0.0, 100.0),
           "Standard deviation of the heights of points that carry none; without it estimated from the points.");
  v.option("assumed_horizontal", o.assumed_horizontal, core::within(0.0, 100.0),
           "Standard deviation of their place along each axis; without it that of the heights (assumed_sigma).");
  v.check(!o.assumed_horizontal || o.assumed_sigma, "assumed_horizontal needs assumed_sigma beside it");
}

/// Width of the border of points around a window that dtm() needs, m: max_edge, one cell, and what roughness (5/12 of max_edge), smoothing
/// and natural neighbours (another max_edge) need beyond.
double halo(const DtmOptions& options);

/// Width of that border from which points are triangulated where none is missing near by, m.
double triangulated_border(const DtmOptions& options);

/// Rows of the points that make the terrain: usable and of one of the classes (all usable ones where there is no class column), flagged
/// where key_points asks for it.
std::vector<std::uint32_t> terrain_rows(const core::Block& block, const DtmOptions& options);

/// Terrain on the cells of `window` (window.cell must be options.cell, else Error) from the points within halo() of it.
/// height: m, of the triangle's plane at the cell's centre, block origin added. count: terrain points in the cell.
/// sigma: m; NaN where a point's sigma is NaN; see the source for its terms. A Block without sigma_v gets sigmas of the points' scatter
/// alone, which does not show what neighbours have in common.
/// reason: none, long_edge or no_data (terrain/voids.h).
/// With `lines` the terrain passes through the breaklines, water is flat or falling and boundaries cut (terrain/water/breaklines.h); cells
/// of water whose height is known have the reason none. `left_out` receives the number of terrain points in the window that share their
/// place with one that is not higher.
core::Grid dtm(const core::Block& block, const core::Lattice& window, const DtmOptions& options, const Breaklines* lines = nullptr,
               std::uint64_t* left_out = nullptr);

}  // namespace swath::terrain

namespace swath::core {
template <>
struct Choices<terrain::Interpolation> {
  static constexpr std::array<std::string_view, 2> names{"linear", "natural_neighbour"};
};
}  // namespace swath::core
