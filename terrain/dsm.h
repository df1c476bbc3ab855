// SPDX-License-Identifier: GPL-3.0-or-later
// Surface model: the highest first return of each cell, or a spike-free TIN of the first returns.
#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "core/block.h"
#include "core/config/option.h"
#include "core/grid.h"
#include "terrain/tin/spike_free.h"

namespace swath::terrain {

enum class SurfaceMethod {
  highest,     ///< the highest first return of a cell
  spike_free,  ///< a TIN of first returns that closes above deep ones (terrain/tin/spike_free.h)
};

struct DsmOptions {
  SurfaceMethod method = SurfaceMethod::highest;
  core::Metres cell{1.0};
  core::Metres max_gap{3.0};
  SpikeFreeOptions spike_free;
};

template <class V>
void describe(DsmOptions& o, V& v) {
  v.option("method", o.method, "highest: highest first return of each cell; spike_free: TIN of first returns without pits.",
           "Khosravipour2016");
  v.option("cell", o.cell, core::above(0.0), "Side of one cell.");
  v.option("max_gap", o.max_gap, core::at_least(0.0),
           "Widest gap filled from the cells around it (diameter of the empty circle); 0: none.");
  describe(o.spike_free, v);
  v.check(o.method == SurfaceMethod::highest || o.max_gap.value > 0.0, "a spike_free surface needs a max_gap above 0");
}

/// Width of the border of points around a window that dsm() needs, m: max_gap and two cells, and what spike_free needs beyond.
double halo(const DsmOptions& options);

/// Rows of the usable first returns (returns of unknown number count as first).
std::vector<std::uint32_t> surface_rows(const core::Block& block);

/// Surface on the cells of `window` (window.cell must be options.cell, else Error) from the points within halo() of it.
/// height: m, block origin added: the highest first return in the cell; in cells without one, up to max_gap, the plane of the Delaunay
/// triangle of the cells' highest returns (at their true positions) around the centre. count: first returns in the cell, 0 where filled.
/// sigma: m, sigma_v of the highest return; the largest of the triangle's three where filled; empty where the Block has no sigma_v.
/// reason: none, long_edge (hole wider than max_gap) or no_data (terrain/voids.h).
core::Grid dsm(const core::Block& block, const core::Lattice& window, const DsmOptions& options);

}  // namespace swath::terrain

namespace swath::core {
template <>
struct Choices<terrain::SurfaceMethod> {
  static constexpr std::array<std::string_view, 2> names{"highest", "spike_free"};
};
}  // namespace swath::core
