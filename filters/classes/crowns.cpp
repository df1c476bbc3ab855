// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/classes/crowns.h"

#include <algorithm>

namespace swath::filters {
namespace {

constexpr double crown_ball = 2.0;    // m
constexpr double crown_column = 1.5;  // m in plan
constexpr double crown_hang = 1.0;    // m: the column begins so far below the return, because rims of crowns hang down
constexpr int crown_weight = 2;       // a crown's returns are fewer than a roof's: at most every second of its pulses goes on
constexpr int crown_cells = 2;        // of the radius

/// Cells from which a cell with a crown's return is within crown_cells in both directions.
std::vector<std::uint8_t> cells_near_crowns(const core::Block& b, const std::vector<Witness>& witness, const core::Lattice& l) {
  std::vector<std::uint8_t> near(l.size(), 0);
  for (size_t p = 0; p < b.size(); ++p) {
    if (witness[p] != Witness::crown) continue;
    const CellIndex c = cell_of(l, b, p);
    for (int j = std::max(c.j - crown_cells, 0); j <= std::min(c.j + crown_cells, l.ny - 1); ++j)
      for (int i = std::max(c.i - crown_cells, 0); i <= std::min(c.i + crown_cells, l.nx - 1); ++i) near[l.at(i, j)] = 1;
  }
  return near;
}

}  // namespace

double crowns_halo() { return crown_ball; }

Crowns::Crowns(const core::Block& b, const std::vector<Witness>& witness)
    : block_(b),
      witness_(witness),
      witnesses_(b, crown_ball / crown_cells, 0, [&](size_t p) { return witness[p] != Witness::none; }),
      near_(cells_near_crowns(b, witness, witnesses_.lattice())) {}

bool Crowns::holds(size_t p) const {
  const core::Lattice& l = witnesses_.lattice();
  const CellIndex c = cell_of(l, block_, p);
  if (!near_[l.at(c.i, c.j)]) return false;  // most roofs have no tree beside them
  int around = 0, above = 0;                 // crown returns, weighted, less roof returns
  for (int v = std::max(c.j - crown_cells, 0); v <= std::min(c.j + crown_cells, l.ny - 1); ++v)
    for (int u = std::max(c.i - crown_cells, 0); u <= std::min(c.i + crown_cells, l.nx - 1); ++u) {
      const auto points = witnesses_.in(u, v);
      const auto rows = witnesses_.rows(u, v);
      for (size_t k = 0; k < points.size(); ++k) {
        if (rows[k] == p) continue;
        const double x = points[k].x - block_.x[p], y = points[k].y - block_.y[p], z = points[k].z - block_.z[p];
        const int vote = witness_[rows[k]] == Witness::crown ? crown_weight : -1;
        if (x * x + y * y + z * z <= crown_ball * crown_ball) around += vote;
        if (x * x + y * y <= crown_column * crown_column && z >= -crown_hang) above += vote;
      }
    }
  return around > 0 && above > 0;
}

}  // namespace swath::filters
