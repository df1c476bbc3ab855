// SPDX-License-Identifier: GPL-3.0-or-later
#include "quality/check_marks.h"

#include <Eigen/Dense>
#include <cmath>
#include <map>

#include "core/statistics.h"

namespace swath::quality {
namespace {

using Eigen::Vector3d;

constexpr size_t least_for_plane = 4;
constexpr double least_spread_of_ground = 0.3;  // of the radius: rms distance from the mean along the narrower axis
constexpr double farthest_mean = 0.5;           // of the radius: the mark lies among its points
constexpr std::uint8_t ground = 2;

struct Points {
  std::vector<Vector3d> at;  // from the mark
  std::vector<double> sigma, sigma_h;
};

MarkReading reading_of(const Points& p, double radius, MarkSurface surface) {
  MarkReading out;
  out.points = static_cast<std::uint32_t>(p.at.size());
  Vector3d mean = Vector3d::Zero();
  for (const Vector3d& v : p.at) mean += v / static_cast<double>(p.at.size());
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  Eigen::Vector2d with_height = Eigen::Vector2d::Zero();
  for (const Vector3d& v : p.at) {
    const Eigen::Vector2d d = (v - mean).head<2>();
    spread += d * d.transpose() / static_cast<double>(p.at.size());
    with_height += d * (v.z() - mean.z()) / static_cast<double>(p.at.size());
  }
  double height = mean.z();
  Eigen::Vector2d gradient = Eigen::Vector2d::Zero();
  const double narrow = std::sqrt(std::max(0.0, Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(spread).eigenvalues()[0]));
  if (surface == MarkSurface::plane && p.at.size() >= least_for_plane && narrow > least_spread_of_ground * radius &&
      mean.head<2>().norm() < farthest_mean * radius) {
    gradient = spread.ldlt().solve(with_height);
    height -= gradient.dot(mean.head<2>());
    out.slope = static_cast<float>(gradient.norm());
  }
  double squares = 0.0;
  for (const Vector3d& v : p.at) squares += std::pow(v.z() - mean.z() - gradient.dot((v - mean).head<2>()), 2);
  out.scatter = static_cast<float>(std::sqrt(squares / static_cast<double>(p.at.size())));
  out.difference = static_cast<float>(height);
  out.sigma = static_cast<float>(core::median(p.sigma, 0.0));
  out.sigma_h = static_cast<float>(core::median(p.sigma_h, 0.0));
  return out;
}

}  // namespace

std::vector<MarkReading> read_marks(const core::Block& b, const std::vector<CheckMark>& marks, const std::vector<size_t>& here,
                                    double radius, MarkSurface surface) {
  std::map<std::pair<size_t, int>, Points> found;
  for (size_t i = 0; i < b.size() && !here.empty(); ++i) {
    if (b.classification[i] != ground || !core::is_usable(b, i)) continue;
    const Vector3d at = b.origin + Vector3d(b.x[i], b.y[i], b.z[i]);
    for (const size_t m : here) {
      const Vector3d d = at - marks[m].at;
      if (d.head<2>().squaredNorm() > radius * radius) continue;
      Points& p = found[{m, b.strip.empty() ? 0 : b.strip[i]}];
      p.at.push_back(d);
      if (!b.sigma_v.empty() && std::isfinite(b.sigma_v[i])) p.sigma.push_back(static_cast<double>(b.sigma_v[i]));
      if (!b.sigma_h.empty() && std::isfinite(b.sigma_h[i])) p.sigma_h.push_back(static_cast<double>(b.sigma_h[i]));
    }
  }
  std::vector<MarkReading> out;
  for (const auto& [key, points] : found) {
    MarkReading r = reading_of(points, radius, surface);
    r.mark = static_cast<std::int32_t>(key.first);
    r.line = key.second;
    out.push_back(r);
  }
  return out;
}

}  // namespace swath::quality
