// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <limits>
#include <vector>

#include "terrain/tin/tin_surface.h"

namespace swath::terrain {

/// Heights at places (Block frame, m); NaN where no triangle covers the place.
inline std::vector<double> heights_at(const Tin& tin, const std::vector<double>& x, const std::vector<double>& y) {
  const std::vector<std::int32_t> at = triangles_at(tin, x, y);
  std::vector<double> out(x.size(), std::numeric_limits<double>::quiet_NaN());
  for (size_t i = 0; i < x.size(); ++i)
    if (at[i] >= 0) out[i] = height_in(tin, at[i], x[i], y[i]);
  return out;
}

}  // namespace swath::terrain
