// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

namespace swath::simulate {

/// Red, green, blue, 0 to 255, of a place (as World) on a thing of an ASPRS class: patches and grain of several sizes, the same for
/// whoever looks at it from wherever.
std::array<std::uint8_t, 3> colour_of(std::uint8_t kind, const Eigen::Vector3d& place, std::int64_t seed);

}  // namespace swath::simulate
