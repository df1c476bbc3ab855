// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace swath::simulate {

/// Unit vector (east, north) of a bearing, rad clockwise from north.
inline Eigen::Vector2d along_bearing(double bearing) { return {std::sin(bearing), std::cos(bearing)}; }

}  // namespace swath::simulate
