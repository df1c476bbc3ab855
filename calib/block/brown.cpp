// SPDX-License-Identifier: GPL-3.0-or-later
// The distortion is inverted by Newton's method with its Jacobian by central differences: 1e-12 mm, or refused.
#include "calib/block/brown.h"

#include <Eigen/LU>
#include <cmath>

namespace swath::calib {
namespace {

using Eigen::Vector2d;

Vector2d distortion(const CameraVector& c, const Vector2d& p) {
  Vector2d d;
  brown(c.data(), p.x(), p.y(), d.x(), d.y());
  return d;
}

/// Does the radial distortion fold over between the middle and r^2? What lies beyond the fold is seen a second time inside it.
bool folds(const CameraVector& c, double r2) {
  constexpr double flattest = 0.1;  // measured by ideal radius
  constexpr int parts = 8;
  for (int k = 1; k <= parts; ++k) {
    const double at = r2 * k / parts;
    if (!(1.0 + at * (3.0 * c[3] + at * (5.0 * c[4] + at * 7.0 * c[5])) > flattest)) return true;
  }
  return false;
}

/// p with p + sign * distortion(p) = target.
std::optional<Vector2d> inverted(const CameraVector& c, double sign, const Vector2d& target) {
  constexpr double step = 1e-5;     // mm
  constexpr double close = 1e-12;   // of the distance from the principal point, or mm
  constexpr double steepest = 0.1;  // determinant below which the polynomial folds over
  Vector2d p = target;
  for (int i = 0; i < 30; ++i) {
    const Vector2d f = p + sign * distortion(c, p) - target;
    Eigen::Matrix2d J;
    for (int k = 0; k < 2; ++k) {
      const Vector2d h = step * Vector2d::Unit(k);
      J.col(k) = Vector2d::Unit(k) + sign * (distortion(c, p + h) - distortion(c, p - h)) / (2.0 * step);
    }
    if (!(J.determinant() > steepest)) return {};
    const Vector2d move = J.inverse() * f;
    p -= move;
    if (move.norm() < close * (1.0 + target.norm())) return p;
  }
  return {};
}

}  // namespace

std::optional<Vector2d> image_of(const CameraVector& c, DistortionAt at, const Eigen::Vector3d& d) {
  if (!(d.z() < 0.0)) return {};
  const Vector2d ideal = -c[0] / d.z() * d.head<2>();
  const Vector2d principal(c[1], c[2]);
  if (at == DistortionAt::ideal) {
    if (folds(c, ideal.squaredNorm())) return {};
    return Vector2d(principal + ideal + distortion(c, ideal));
  }
  const auto measured = inverted(c, -1.0, ideal);
  if (!measured) return {};
  return Vector2d(principal + *measured);
}

std::optional<Eigen::Vector3d> direction_of(const CameraVector& c, DistortionAt at, const Vector2d& measured) {
  const Vector2d centred = measured - Vector2d(c[1], c[2]);
  if (at == DistortionAt::measured) {
    const Vector2d ideal = centred - distortion(c, centred);
    return Eigen::Vector3d(ideal.x(), ideal.y(), -c[0]);
  }
  const auto ideal = inverted(c, 1.0, centred);
  if (!ideal) return {};
  return Eigen::Vector3d(ideal->x(), ideal->y(), -c[0]);
}

}  // namespace swath::calib
