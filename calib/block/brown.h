// SPDX-License-Identifier: GPL-3.0-or-later
// A frame camera: interior orientation with Brown's distortion (Brown 1971; affinity as in Fraser 1997).
//
// Image plane, mm: x to the right, y up, origin in the middle of the sensor. Camera axes: x and y as in the image, z from the scene to the
// camera, so that a point of the scene has negative z. An ideal point is x = x0 - f d1 / d3, y = y0 - f d2 / d3 with the point d in camera
// axes. Distortion is measured less ideal:
//   dx = x (k1 r^2 + k2 r^4 + k3 r^6) + p1 (r^2 + 2 x^2) + 2 p2 x y + b1 x + b2 y
//   dy = y (k1 r^2 + k2 r^4 + k3 r^6) + p2 (r^2 + 2 y^2) + 2 p1 x y
// with x, y from the principal point: of the ideal point, or of the measured one, as `at` says. Papers that write a correction (ideal less
// measured) have the opposite signs.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string_view>

#include "core/records/camera.h"

namespace swath::calib {

inline constexpr int camera_values = 10;
/// f, x0, y0 in mm; k1 mm^-2, k2 mm^-4, k3 mm^-6; p1, p2 mm^-1; b1, b2 without unit.
inline constexpr std::array<std::string_view, camera_values> camera_keys{"f", "x0", "y0", "k1", "k2", "k3", "p1", "p2", "b1", "b2"};
using CameraVector = Eigen::Matrix<double, camera_values, 1>;

using core::DistortionAt;

/// `c`: the values by camera_keys; x, y from the principal point.
template <class T>
void brown(const T* c, const T& x, const T& y, T& dx, T& dy) {
  const T r2 = x * x + y * y;
  const T radial = r2 * (c[3] + r2 * (c[4] + r2 * c[5]));
  const T xy = 2.0 * x * y;
  dx = x * radial + c[6] * (r2 + 2.0 * x * x) + c[7] * xy + c[8] * x + c[9] * y;
  dy = y * radial + c[7] * (r2 + 2.0 * y * y) + c[6] * xy;
}

/// Measured point of a direction d in camera axes (d3 < 0), mm; nothing where the distortion does not converge or folds over, or d is
/// not in front.
std::optional<Eigen::Vector2d> image_of(const CameraVector& camera, DistortionAt at, const Eigen::Vector3d& d);

/// The direction of a measured point in camera axes: (x, y, -f) less distortion, not normalised; nothing where it does not converge.
std::optional<Eigen::Vector3d> direction_of(const CameraVector& camera, DistortionAt at, const Eigen::Vector2d& measured);

}  // namespace swath::calib
