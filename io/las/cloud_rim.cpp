// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/las/cloud_rim.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace swath::io {
namespace {

void keep_inside(std::vector<double>& values, double origin, double rim, double step) {
  // Not less than what a sum of origin and coordinate can show.
  const double inside = std::max(1e-3 * step, 4.0 * std::numeric_limits<double>::epsilon() * std::max(std::abs(rim), std::abs(origin)));
  const double last = rim - origin;
  for (double& v : values)
    if (std::abs(v - last) < 0.5 * step) v = last - inside;
}

}  // namespace

void keep_rim_inside(core::Block& block, const Eigen::Vector2d& rim, const Eigen::Vector2d& step) {
  keep_inside(block.x, block.origin.x(), rim.x(), step.x());
  keep_inside(block.y, block.origin.y(), rim.y(), step.y());
}

}  // namespace swath::io
