// SPDX-License-Identifier: GPL-3.0-or-later
// Sensors of an IMU that stop: one axis repeats a value while the others go on.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace swath::io {

/// Records [first, last) that repeat the value of the one before `first` in one axis.
struct FrozenAxis {
  size_t axis = 0;  ///< 0 to 2 gyro x y z, 3 to 5 accelerometer x y z
  size_t first = 0, last = 0;
};

/// By axis, then by record. A stretch counts where so many repeats in a row do not come by chance, as often as the axis repeats its value
/// on either side, and another axis goes on with the noise that it has there: neither coarse digits nor a body at rest are taken for it.
std::vector<FrozenAxis> frozen_axes(const std::vector<Eigen::Vector3d>& gyro, const std::vector<Eigen::Vector3d>& accelerometer);

/// Axes, numbered as above, that have one value from the first record to the last, but for up to 100 at either end, while gyros and
/// accelerometers each have an axis that shows noise in many steps of its digits. Neither motion without noise nor a body at rest in coarse
/// digits is taken for it.
std::vector<size_t> standing_axes(const std::vector<Eigen::Vector3d>& gyro, const std::vector<Eigen::Vector3d>& accelerometer);

}  // namespace swath::io
