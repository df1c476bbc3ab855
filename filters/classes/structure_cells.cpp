// SPDX-License-Identifier: GPL-3.0-or-later
// Region growing by cells. A region larger than the square in which it is looked at counts as large as its part in the square, so that
// a tile need not hold all of it.
#include "filters/classes/structure_cells.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace swath::filters {
namespace {

/// Of the planar points of a cell, as many as its sums can hold.
void add(PlanarSums& s, double east, double north) {
  constexpr double cm = 100.0;
  constexpr std::int32_t most = 100'000;
  if (s.n == most) return;
  const auto x = static_cast<std::int32_t>(cm * east), y = static_cast<std::int32_t>(cm * north);
  s.n += 1, s.x += x, s.y += y, s.xx += x * x, s.xy += x * y, s.yy += y * y;
}

}  // namespace

StructureCells structure_cells(const core::Block& b, const std::vector<Planar>& planar, const core::Lattice& l) {
  StructureCells out;
  out.lattice = l;
  out.plane.assign(out.lattice.size(), std::numeric_limits<float>::quiet_NaN());
  out.height = out.ground = out.low = out.plane;
  out.kind.assign(out.lattice.size(), Planar::none);
  out.sums.assign(out.lattice.size(), {});
  for (size_t p = 0; p < b.size(); ++p) {
    if (!core::is_usable(b, p)) continue;
    const CellIndex at = cell_of(out.lattice, b, p);
    if (!out.lattice.holds(at.i, at.j)) continue;
    const size_t c = out.lattice.at(at.i, at.j);
    const auto z = static_cast<float>(b.z[p]);
    out.kind[c] = std::max(out.kind[c], planar[p]);
    if (!(z > out.low[c])) out.low[c] = z;
    if (planar[p] != Planar::none) {
      const double half = 0.5 * structure_cell;
      add(out.sums[c], b.origin.x() + b.x[p] - out.lattice.centre_x(at.i) + half,
          b.origin.y() + b.y[p] - out.lattice.centre_y(at.j) + half);
    }
    if (planar[p] != Planar::none && !(z < out.plane[c])) {
      out.height[c] = z > out.plane[c] || !out.has_plane(c) ? b.height[p] : std::max(out.height[c], b.height[p]);
      out.plane[c] = z;
    }
    if (b.classification[p] == core::point_class::ground && !(z > out.ground[c])) out.ground[c] = z;
  }
  return out;
}

}  // namespace swath::filters
