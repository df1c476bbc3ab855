// SPDX-License-Identifier: GPL-3.0-or-later
// The windows in which planes are looked for end within a roof, so that slivers of it have too few returns of their own; and walls are too
// steep for airborne beams to show a plane. Both are recognised by the roof beside them. A hedge along a wall, within a metre, is taken
// with it.
#include "filters/classes/building_sides.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <tuple>

#include "core/parallel.h"
#include "filters/bins.h"

namespace swath::filters {
namespace {

using Eigen::Vector3d;

constexpr double rim_reach = 3.0;   // m: half a window
constexpr double wall_reach = 1.0;  // m: overhang of eaves and half the distance of returns
constexpr double foot_reach = 0.7;  // m: the same for the foot of a wall
constexpr float wall_room = 0.5f;   // m that a roof is higher than the lowest ones, above the foot of a wall
constexpr size_t fewest_seen = 6;
constexpr size_t nearest = 12;           // returns of the roof that make the plane
constexpr size_t points_at_once = 2048;  // of one thread
constexpr double flattest = 0.1;         // rms across over rms along the lesser axis of these: less is a plane

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

/// The returns of roofs around a return, by rings of cells as wide as walls are searched for.
class Surroundings {
 public:
  Surroundings(const Bins& roofs, const core::Block& b) : roofs_(roofs), block_(b) {}

  /// Is there a higher one within wall_reach in plan? What is itself lower than a roof can be must stand closer, under a roof that leaves
  /// room for a wall: hedges, bicycles and cars stand along houses too.
  bool under_eaves(size_t p, float lowest_roof) const {
    const bool low = block_.height[p] < lowest_roof;
    const double reach = low ? foot_reach : wall_reach,
                 least = block_.z[p] + (low ? static_cast<double>(lowest_roof + wall_room - block_.height[p]) : 0.0);
    const CellIndex c = cell_of(roofs_.lattice(), block_, p);
    for (int dj = -1; dj <= 1; ++dj)
      for (int di = -1; di <= 1; ++di) {
        if (!roofs_.lattice().holds(c.i + di, c.j + dj)) continue;
        for (const Bins::Point& q : roofs_.in(c.i + di, c.j + dj)) {
          const double x = q.x - block_.x[p], y = q.y - block_.y[p];
          if (q.z > block_.z[p] && q.z >= least && x * x + y * y <= reach * reach) return true;
        }
      }
    return false;
  }

  /// The `nearest` within rim_reach in plan, seen from p; false where there are fewer than `fewest_seen`.
  bool nearest_of(size_t p, std::vector<Vector3d>& out) {
    const CellIndex c = cell_of(roofs_.lattice(), block_, p);
    around_.clear();
    const auto rings = static_cast<int>(rim_reach / wall_reach);
    for (int ring = 0; ring <= rings; ++ring) {
      add_ring(p, c, ring);
      // All within `ring` cells' width are known now.
      const double known = ring * wall_reach;
      if (static_cast<size_t>(std::count_if(around_.begin(), around_.end(), [&](const auto& a) { return a.first <= known * known; })) >=
          nearest)
        break;
    }
    if (around_.size() < fewest_seen) return false;
    const auto before = [](const auto& a, const auto& o) {
      return std::make_tuple(a.first, a.second.x(), a.second.y(), a.second.z()) <
             std::make_tuple(o.first, o.second.x(), o.second.y(), o.second.z());
    };
    const size_t n = std::min(around_.size(), nearest);
    std::partial_sort(around_.begin(), around_.begin() + static_cast<std::ptrdiff_t>(n), around_.end(), before);
    out.clear();
    for (size_t k = 0; k < n; ++k) out.push_back(around_[k].second);
    return true;
  }

 private:
  void add_ring(size_t p, CellIndex c, int ring) {
    for (int dj = -ring; dj <= ring; ++dj)
      for (int di = -ring; di <= ring; di += std::abs(dj) == ring || di == ring ? 1 : 2 * ring) {
        if (!roofs_.lattice().holds(c.i + di, c.j + dj)) continue;
        for (const Bins::Point& q : roofs_.in(c.i + di, c.j + dj)) {
          const Vector3d to(q.x - block_.x[p], q.y - block_.y[p], q.z - block_.z[p]);
          const double d2 = to.head<2>().squaredNorm();
          if (d2 <= rim_reach * rim_reach) around_.emplace_back(d2, to);
        }
      }
  }

  const Bins& roofs_;
  const core::Block& block_;
  std::vector<std::pair<double, Vector3d>> around_;
};

}  // namespace

double building_sides_halo() { return rim_reach; }

std::vector<std::uint8_t> building_sides(const core::Block& b, const std::vector<std::uint8_t>& roof,
                                         const std::vector<std::uint8_t>& candidate, double tolerance, double lowest_roof, size_t own) {
  std::vector<std::uint8_t> out(b.size(), 0);
  if (b.size() == 0) return out;
  const Bins roofs(b, wall_reach, 0, [&](size_t p) { return roof[p] != 0; });
  core::in_parallel(own, points_at_once, [&](size_t from, size_t to) {
    Surroundings around(roofs, b);
    std::vector<Vector3d> plane;
    for (size_t p = from; p < to; ++p) {
      if (!candidate[p] || roof[p] || !core::is_last_return(b, p)) continue;
      out[p] = around.under_eaves(p, static_cast<float>(lowest_roof)) || (around.nearest_of(p, plane) && on_plane(plane, tolerance));
    }
  });
  return out;
}

}  // namespace swath::filters
