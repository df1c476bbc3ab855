// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/ring.h"

namespace swath::core {

double signed_area(const std::vector<Eigen::Vector2d>& ring) {
  double sum = 0.0;
  for (size_t k = 0; k < ring.size(); ++k) {
    const Eigen::Vector2d a = ring[k] - ring[0], b = ring[(k + 1) % ring.size()] - ring[0];
    sum += 0.5 * (a.x() * b.y() - a.y() * b.x());
  }
  return sum;
}

bool crosses_eastward(const Eigen::Vector2d& a, const Eigen::Vector2d& b, double x, double y) {
  const Eigen::Vector2d &low = a.y() < b.y() ? a : b, &high = a.y() < b.y() ? b : a;
  return low.y() <= y && y < high.y() && x < low.x() + (y - low.y()) / (high.y() - low.y()) * (high.x() - low.x());
}

}  // namespace swath::core
