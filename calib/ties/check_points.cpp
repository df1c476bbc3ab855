// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/ties/check_points.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

namespace swath::calib {

using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

constexpr double wall = 0.5;    // cosine of the slope from which on a plane has no height
constexpr double margin = 0.5;  // m: returns nearer than this to a plane's outline may hang over it
constexpr double widest = 2.0;  // m

/// A point at the middle of a plane's corners.
CheckPoint middle_of(const SurveyedTarget& t, const Vector3d& map) {
  double weights = 0.0, nearest = widest + margin;
  for (const PlaneControl& c : t.control) weights += 1.0 / (c.sigma * c.sigma);
  for (size_t k = 0; k < t.corners.size(); ++k) {
    const Vector3d from = t.corners[k], way = t.corners[(k + 1) % t.corners.size()] - from, to = t.centre - from;
    nearest = std::min(nearest, (to - std::clamp(to.dot(way) / way.squaredNorm(), 0.0, 1.0) * way).head<2>().norm());
  }
  return {t.name, map, 1.0 / (std::sqrt(weights) * t.normal.z()), std::max(nearest - margin, margin)};
}

}  // namespace

std::vector<CheckPoint> check_points_of(const std::vector<SurveyedTarget>& targets, const std::function<Vector3d(const Vector3d&)>& map) {
  std::vector<CheckPoint> out;
  for (const SurveyedTarget& t : targets) {
    if (t.use != io::ControlUse::check) continue;
    if (t.is_point)
      out.push_back({t.name, map(t.centre), t.control.front().sigma});
    else if (t.normal.z() > wall)
      out.push_back(middle_of(t, map(t.centre)));
  }
  return out;
}

void CheckPoints::add(const core::Block& b) {
  if (b.size() == 0) return;
  const auto [west, east] = std::minmax_element(b.x.begin(), b.x.end());
  const auto [south, north] = std::minmax_element(b.y.begin(), b.y.end());
  for (size_t k = 0; k < points_.size(); ++k) {
    const Vector3d p = points_[k].map - b.origin;
    const double radius = radius_of(k);
    if (p.x() < *west - radius || p.x() > *east + radius || p.y() < *south - radius || p.y() > *north + radius) continue;
    for (size_t i = 0; i < b.size(); ++i) {
      const Eigen::Vector4d row(1, b.x[i] - p.x(), b.y[i] - p.y(), b.z[i] - p.z());
      if (row[1] * row[1] + row[2] * row[2] > radius * radius) continue;
      if (!core::is_last_return(b, i) || (!b.return_number.empty() && b.return_number[i] > 1)) continue;
      moments_[k].n += 1;
      moments_[k].sum += row * row.transpose();
    }
  }
}

std::vector<CheckResidual> CheckPoints::residuals() const {
  constexpr double least = 6;
  std::vector<CheckResidual> out;
  for (size_t k = 0; k < points_.size(); ++k) {
    const Moments& m = moments_[k];
    CheckResidual r{points_[k].name, static_cast<std::uint64_t>(m.n), std::numeric_limits<double>::quiet_NaN(), points_[k].sigma, 0.0};
    const Matrix3d N = m.sum.topLeftCorner<3, 3>();
    const Eigen::LDLT<Matrix3d> factors(N);
    // The returns must lie around the point: their spread along the worse direction a quarter of the radius.
    const Eigen::Matrix2d spread = m.n > 0 ? Eigen::Matrix2d(N.bottomRightCorner<2, 2>() / m.n) : Eigen::Matrix2d::Zero();
    const double half = 0.5 * spread.trace(), narrow = half - std::sqrt(std::max(0.0, half * half - spread.determinant()));
    if (m.n >= least && narrow > std::pow(0.25 * radius_of(k), 2) / 2) {
      const Vector3d right = m.sum.topRightCorner<3, 1>(), plane = factors.solve(right);
      const double squares = std::max(0.0, m.sum(3, 3) - plane.dot(right)) / (m.n - 3);
      r.difference = plane[0];
      r.roughness = std::sqrt(squares);
      r.sigma = std::sqrt(r.sigma * r.sigma + squares * factors.solve(Vector3d::UnitX())[0]);
    }
    out.push_back(r);
  }
  return out;
}

}  // namespace swath::calib
