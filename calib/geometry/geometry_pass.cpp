// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/geometry/geometry_pass.h"

#include <algorithm>
#include <cmath>

namespace swath::calib {

using Eigen::Vector2d;

CourseBox::CourseBox(const Pass& pass) : pass_(pass), ahead_(std::sin(pass.course), std::cos(pass.course)) {
  for (const Vector2d& v : pass.track) {
    along_.push_back(v.dot(ahead_));
    const double across = across_of(v);
    left_ = std::min(left_, across), right_ = std::max(right_, across);
  }
}

std::optional<std::pair<double, double>> CourseBox::nearest(const Vector2d& place, double reach) const {
  const double here = place.dot(ahead_), across = across_of(place);
  if (across < left_ - reach || across > right_ + reach) return std::nullopt;
  std::optional<std::pair<double, double>> best;
  const auto first = std::lower_bound(along_.begin(), along_.end(), here - reach) - along_.begin();
  for (auto i = static_cast<size_t>(first); i < along_.size() && along_[i] <= here + reach; ++i)
    if (const double d = (pass_.track[i] - place).norm(); d < (best ? best->first : reach)) best = {d, pass_.time[i]};
  return best;
}

}  // namespace swath::calib
