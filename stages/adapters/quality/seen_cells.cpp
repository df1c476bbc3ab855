// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/adapters/quality/seen_cells.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/grid.h"

namespace swath::stages {
namespace {

constexpr double seen_side = 25.0;  // m

}  // namespace

std::vector<SeenCell> seen_cells(const core::Block& block, std::size_t own) {
  std::vector<SeenCell> out;
  for (size_t p = 0; p < own; ++p) {
    if (!core::is_usable(block, p)) continue;
    const SeenCell cell{static_cast<std::int32_t>(core::cell_index(block.origin.x() + block.x[p], seen_side)),
                        static_cast<std::int32_t>(core::cell_index(block.origin.y() + block.y[p], seen_side))};
    if (out.empty() || out.back() != cell) out.push_back(cell);
  }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

double away(const std::vector<SeenCell>& seen, const Eigen::Vector3d& at) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const SeenCell& c : seen) {
    const double x0 = c.i * seen_side, y0 = c.j * seen_side;
    const double dx = std::max({x0 - at.x(), 0.0, at.x() - x0 - seen_side}), dy = std::max({y0 - at.y(), 0.0, at.y() - y0 - seen_side});
    nearest = std::min(nearest, dx * dx + dy * dy);
  }
  return std::sqrt(nearest);
}

}  // namespace swath::stages
