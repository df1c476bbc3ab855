// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/corridor/obstacles.h"

#include <Eigen/Cholesky>
#include <cmath>

#include "core/grid.h"

namespace swath::terrain {
namespace {

constexpr double obstacle_cell = 4.0;  // m
constexpr size_t plane_fewest = 6;     // returns of a plane
constexpr double off_plane = 3.0;
constexpr double ground_least_sigma = 0.005;  // m, of a return

}  // namespace

Obstacles::Obstacles(const std::vector<Obstacle>& all) : all_(all) {
  for (std::uint32_t p = 0; p < all.size(); ++p)
    cells_[{core::cell_index(all[p].x, obstacle_cell), core::cell_index(all[p].y, obstacle_cell)}].push_back(p);
}

void Obstacles::in_box(double west, double south, double east, double north, const std::function<void(const Obstacle&)>& f) const {
  const std::int64_t i0 = core::cell_index(west, obstacle_cell), i1 = core::cell_index(east, obstacle_cell),
                     j0 = core::cell_index(south, obstacle_cell), j1 = core::cell_index(north, obstacle_cell);
  for (std::int64_t i = i0; i <= i1; ++i)
    for (auto at = cells_.lower_bound({i, j0}); at != cells_.end() && at->first <= std::pair(i, j1); ++at)
      for (const std::uint32_t p : at->second) f(all_[p]);
}

std::optional<GroundHeight> Obstacles::ground(const Eigen::Vector2d& at) const {
  for (const double radius : {2.0, 4.0, 8.0})
    if (const auto found = plane(at, radius)) return found;
  return std::nullopt;
}

std::optional<GroundHeight> Obstacles::plane(const Eigen::Vector2d& at, double radius) const {
  std::vector<Eigen::Vector3d> on;
  in_box(at.x() - radius, at.y() - radius, at.x() + radius, at.y() + radius, [&](const Obstacle& o) {
    const Eigen::Vector3d d(o.x - at.x(), o.y - at.y(), o.z);
    if (o.kind == Hazard::ground && d.head<2>().norm() <= radius) on.push_back(d);
  });
  GroundHeight out;
  for (int round = 0; round < 2; ++round) {
    if (on.size() < plane_fewest) return std::nullopt;
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& d : on) {
      const Eigen::Vector3d row(1.0, d.x(), d.y());
      normal += row * row.transpose();
      right += row * (d.z() - on[0].z());
    }
    const Eigen::LDLT<Eigen::Matrix3d> solver(normal);
    const Eigen::Vector3d c = solver.solve(right);
    if (!c.allFinite()) return std::nullopt;
    double squares = 0.0;
    const auto residual = [&, z0 = on[0].z()](const Eigen::Vector3d& d) { return d.z() - z0 - c(0) - c(1) * d.x() - c(2) * d.y(); };
    for (const Eigen::Vector3d& d : on) squares += std::pow(residual(d), 2);
    const double sigma = std::max(ground_least_sigma, std::sqrt(squares / (static_cast<double>(on.size()) - 3.0)));
    out = {on[0].z() + c(0), sigma * std::sqrt(solver.solve(Eigen::Vector3d::UnitX()).x())};
    std::vector<Eigen::Vector3d> near;
    for (const Eigen::Vector3d& d : on)
      if (std::abs(residual(d)) <= off_plane * sigma) near.push_back(d);
    on = std::move(near);
  }
  return out;
}

}  // namespace swath::terrain
