// SPDX-License-Identifier: GPL-3.0-or-later
// The windows in which planes are looked for end within a roof, so that slivers of it have too few returns of their own; and walls are too
// steep for airborne beams to show a plane. Both are told by the roof beside them. A hedge along a wall, within a metre, is taken with it.
#include "filters/building_sides.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <tuple>

#include "filters/bins.h"

namespace swath::filters {
namespace {

using Eigen::Vector3d;

constexpr double rim_reach = 3.0;   // m: half a window
constexpr double wall_reach = 1.0;  // m: overhang of eaves and half the distance of returns
constexpr size_t fewest = 6;
constexpr size_t nearest = 12;    // returns of the roof that make the plane
constexpr double flattest = 0.1;  // rms across over rms along the lesser axis of these: less tells a plane

/// Is the origin on the plane through the points?
bool on_plane(const std::vector<Vector3d>& points, double tolerance) {
  Vector3d mean = Vector3d::Zero();
  for (const Vector3d& p : points) mean += p / static_cast<double>(points.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Vector3d& p : points) spread += (p - mean) * (p - mean).transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(spread);
  const bool flat = axes.eigenvalues()(0) <= flattest * flattest * axes.eigenvalues()(1);
  return flat && std::abs(axes.eigenvectors().col(0).dot(mean)) <= tolerance;
}

}  // namespace

double building_sides_halo() { return rim_reach; }

std::vector<std::uint8_t> building_sides(const core::Block& b, const std::vector<std::uint8_t>& roof,
                                         const std::vector<std::uint8_t>& candidate, double tolerance) {
  std::vector<std::uint8_t> out(b.size(), 0);
  if (b.size() == 0) return out;
  const Bins roofs(b, rim_reach, 1, [&](size_t p) { return roof[p] != 0; });
  const core::Lattice& l = roofs.lattice();
  std::vector<std::pair<double, Vector3d>> around;
  std::vector<Vector3d> plane;
  for (size_t p = 0; p < b.size(); ++p) {
    if (!candidate[p] || roof[p] || !core::is_last_return(b, p)) continue;
    const CellIndex c = cell_of(l, b, p);
    around.clear();
    for (int dj = -1; dj <= 1; ++dj)
      for (int di = -1; di <= 1; ++di)
        for (const Bins::Point& q : roofs.in(c.i + di, c.j + dj)) {
          const Vector3d to(q.x - b.x[p], q.y - b.y[p], q.z - b.z[p]);
          const double d2 = to.head<2>().squaredNorm();
          if (d2 > rim_reach * rim_reach) continue;
          if (d2 <= wall_reach * wall_reach && to.z() > 0.0) out[p] = 1;
          around.emplace_back(d2, to);
        }
    if (out[p] || around.size() < fewest) continue;
    std::sort(around.begin(), around.end(), [](const auto& a, const auto& o) {
      return std::make_tuple(a.first, a.second.x(), a.second.y(), a.second.z()) <
             std::make_tuple(o.first, o.second.x(), o.second.y(), o.second.z());
    });
    plane.clear();
    for (size_t k = 0; k < std::min(around.size(), nearest); ++k) plane.push_back(around[k].second);
    out[p] = on_plane(plane, tolerance);
  }
  return out;
}

}  // namespace swath::filters
