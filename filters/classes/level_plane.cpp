// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/classes/level_plane.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <tuple>

namespace swath::filters {
namespace {

using Eigen::Vector3d;

constexpr double prior_slope = 0.001;  // standard deviation
constexpr double least_sigma = 0.01;   // m
constexpr double least_spread = 1.0;   // m2

}  // namespace

std::optional<LevelPlane> level_plane(std::vector<Vector3d>& s, double steepest, double most_uncertain) {
  std::sort(s.begin(), s.end(),
            [](const Vector3d& a, const Vector3d& b) { return std::tie(a.x(), a.y(), a.z()) < std::tie(b.x(), b.y(), b.z()); });
  const auto n = static_cast<double>(s.size());
  LevelPlane found;
  for (const Vector3d& r : s) found.centre += r / n;
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  Eigen::Vector2d moment = Eigen::Vector2d::Zero();
  double left = 0;
  for (const Vector3d& r : s) {
    const Eigen::Vector2d d(r.x() - found.centre.x(), r.y() - found.centre.y());
    const double dz = r.z() - found.centre.z();
    spread += d * d.transpose();
    moment += d * dz;
    left += dz * dz;
  }
  // Along each axis on its own: the least squares' slope and its standard deviation.
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(spread);
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();
  for (int k = 0; k < 2; ++k) {
    const double lambda = axes.eigenvalues()(k);
    if (!(lambda > least_spread)) continue;
    slope(k) = axes.eigenvectors().col(k).dot(moment) / lambda;
    left -= slope(k) * slope(k) * lambda;
  }
  found.sigma = std::max(std::sqrt(std::max(left, 0.0) / std::max(n - 3.0, 1.0)), least_sigma);
  for (int k = 0; k < 2; ++k) {
    const double lambda = std::max(axes.eigenvalues()(k), least_spread), uncertain = found.sigma / std::sqrt(lambda);
    if (k == 1 && uncertain > most_uncertain) return std::nullopt;  // not even along its longer axis
    if (std::abs(slope(k)) > steepest + 2.0 * uncertain) return std::nullopt;
    slope(k) *= lambda / (lambda + found.sigma * found.sigma / (prior_slope * prior_slope));
  }
  const Eigen::Vector2d gradient = axes.eigenvectors() * slope;
  found.east = gradient.x();
  found.north = gradient.y();
  return found;
}

}  // namespace swath::filters
