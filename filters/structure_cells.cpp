// SPDX-License-Identifier: GPL-3.0-or-later
// Region growing by cells. A region larger than the square in which it is looked at counts as large as its part in the square, so that
// a tile need not hold all of it.
#include "filters/structure_cells.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace swath::filters {

StructureCells structure_cells(const core::Block& b, const std::vector<std::uint8_t>& planar) {
  StructureCells out;
  out.lattice = lattice_around(b, structure_cell, 0);
  out.plane.assign(out.lattice.size(), std::numeric_limits<float>::quiet_NaN());
  out.height = out.ground = out.plane;
  for (size_t p = 0; p < b.size(); ++p) {
    if (!core::is_usable(b, p)) continue;
    const CellIndex at = cell_of(out.lattice, b, p);
    const size_t c = out.lattice.at(at.i, at.j);
    const auto z = static_cast<float>(b.z[p]);
    if (planar[p] && !(z < out.plane[c])) {
      out.height[c] = z > out.plane[c] || !out.has_plane(c) ? b.height[p] : std::max(out.height[c], b.height[p]);
      out.plane[c] = z;
    }
    if (b.classification[p] == core::point_class::ground && !(z > out.ground[c])) out.ground[c] = z;
  }
  return out;
}

bool grow(const core::Lattice& l, int i, int j, int radius, const std::function<bool(size_t, size_t)>& linked,
          const std::function<bool(size_t, int)>& enough) {
  const int side = 2 * radius + 1;
  std::vector<std::uint8_t> seen(static_cast<size_t>(side) * static_cast<size_t>(side), 0);
  const auto local = [&](int di, int dj) {
    return static_cast<size_t>(dj + radius) * static_cast<size_t>(side) + static_cast<size_t>(di + radius);
  };
  std::vector<CellIndex> found{{0, 0}};
  seen[local(0, 0)] = 1;
  for (size_t n = 0; n < found.size(); ++n) {
    const CellIndex from = found[n];
    const size_t cell = l.at(i + from.i, j + from.j);
    if (enough(cell, static_cast<int>(n) + 1)) return true;
    for (int dj = -structure_link; dj <= structure_link; ++dj)
      for (int di = -structure_link; di <= structure_link; ++di) {
        const CellIndex to{from.i + di, from.j + dj};
        if (std::max(std::abs(to.i), std::abs(to.j)) > radius || !l.holds(i + to.i, j + to.j) || seen[local(to.i, to.j)]) continue;
        if (!linked(cell, l.at(i + to.i, j + to.j))) continue;
        seen[local(to.i, to.j)] = 1;
        found.push_back(to);
      }
  }
  return false;
}

}  // namespace swath::filters
