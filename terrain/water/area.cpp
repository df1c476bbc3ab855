// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/water/area.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/ring.h"

namespace swath::terrain {

Area::Area(const std::vector<std::vector<Eigen::Vector3d>>& rings) {
  x0_ = y0_ = std::numeric_limits<double>::infinity();
  x1_ = y1_ = -x0_;
  for (const auto& ring : rings)
    for (size_t k = 0; k < ring.size(); ++k) {
      const Eigen::Vector3d &a = ring[k], &b = ring[(k + 1) % ring.size()];
      x0_ = std::min(x0_, a.x());
      x1_ = std::max(x1_, a.x());
      y0_ = std::min(y0_, a.y());
      y1_ = std::max(y1_, a.y());
      if (a.y() == b.y()) continue;
      const bool up = a.y() < b.y();
      const Eigen::Vector3d &low = up ? a : b, &high = up ? b : a;
      sides_.push_back({low.x(), low.y(), high.x(), high.y()});
    }
  rows_.resize(std::clamp<size_t>(sides_.size() / 4, 1, 65536));
  for (size_t s = 0; s < sides_.size(); ++s)
    for (size_t r = row_of(sides_[s].y0); r <= row_of(sides_[s].y1); ++r) rows_[r].push_back(static_cast<std::uint32_t>(s));
}

size_t Area::row_of(double y) const {
  const double span = y1_ - y0_;
  if (!(span > 0)) return 0;
  return static_cast<size_t>(
      std::clamp(std::floor((y - y0_) / span * static_cast<double>(rows_.size())), 0.0, static_cast<double>(rows_.size() - 1)));
}

bool Area::holds(double x, double y) const {
  if (!(x >= x0_ && x <= x1_ && y >= y0_ && y <= y1_)) return false;
  bool inside = false;
  for (const std::uint32_t s : rows_[row_of(y)]) {
    const Side& e = sides_[s];
    inside = inside != core::crosses_eastward({e.x0, e.y0}, {e.x1, e.y1}, x, y);
  }
  return inside;
}

}  // namespace swath::terrain
