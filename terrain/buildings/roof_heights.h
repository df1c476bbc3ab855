// SPDX-License-Identifier: GPL-3.0-or-later
// Heights of a building's roof and of the ground around it.
#pragma once

#include <cmath>
#include <functional>

#include "terrain/buildings/building.h"

namespace swath::terrain {

/// Calls f(place, unit vector to the right) along a ring, one place for each started `step` (m) of a side.
template <class F>
void for_each_place(const Ring& ring, double step, F&& f) {
  for (size_t k = 0; k < ring.size(); ++k) {
    const Eigen::Vector2d side = ring[(k + 1) % ring.size()] - ring[k];
    const double length = side.norm();
    if (!(length > 0.0)) continue;
    const Eigen::Vector2d right(side.y() / length, -side.x() / length);
    const int n = static_cast<int>(std::ceil(length / step));
    for (int i = 0; i < n; ++i) f(Eigen::Vector2d(ring[k] + (i + 0.5) / n * side), right);
  }
}

/// Sets the building's heights and share explained; its outline is known. Heights of planes are taken along the outline and where two of
/// them meet between two neighbours of the TIN, so that they reach edges and ridges, beyond the returns.
void measure_heights(const Tin& tin, const RoofPlanes& roof, const std::function<double(const Eigen::Vector2d&)>& ground, Building& b);

}  // namespace swath::terrain
