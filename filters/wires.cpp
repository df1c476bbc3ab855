// SPDX-License-Identifier: GPL-3.0-or-later
// After McLaughlin 2006, "Extracting transmission lines from airborne LIDAR data", IEEE GRSL 3: transmission lines by the linear spread of
// an ellipsoidal neighbourhood, surfaces and foliage told from them by theirs. Deviation: lines through the point and each of its
// neighbours are tried in place of an eigenvector, because wires run side by side. A catenary leaves its tangent by 6 cm over 6 m where its
// parameter is 300 m.
#include "filters/wires.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <tuple>

#include "filters/bins.h"

namespace swath::filters {
namespace {

using Eigen::Vector3d;

constexpr double reach = 6.0;           // m
constexpr double on_line = 0.5;         // m; holds a bundle of conductors together
constexpr double clear_tube = 1.5;      // m around the line
constexpr double shortest = 5.0;        // m of line
constexpr double least_baseline = 1.0;  // m from the point to the one that gives the direction
constexpr int fewest = 4;               // other points on the line
constexpr size_t fewest_in_line = 3;    // of those again, that are in line themselves
constexpr double most_beside = 0.2;     // of the points within the tube may lie off the line
constexpr double steepest = 0.5;        // sine of the line's inclination
constexpr size_t most_nearest = 48;     // neighbours looked at

struct Neighbour {
  double distance2;
  Vector3d to;
};

std::vector<Neighbour> within(const Bins& bins, const core::Block& b, size_t p, double radius) {
  std::vector<Neighbour> out;
  const core::Lattice& l = bins.lattice();
  const CellIndex c = cell_of(l, b, p);
  const Vector3d at(b.x[p], b.y[p], b.z[p]);
  for (int dj = -1; dj <= 1; ++dj)
    for (int di = -1; di <= 1; ++di)
      for (const Bins::Point& q : bins.in(c.i + di, c.j + dj)) {
        const Vector3d to = Vector3d(q.x, q.y, q.z) - at;
        const double d2 = to.squaredNorm();
        if (d2 > 0.0 && d2 <= radius * radius) out.push_back({d2, to});
      }
  std::sort(out.begin(), out.end(), [](const Neighbour& a, const Neighbour& o) {
    return std::make_tuple(a.distance2, a.to.x(), a.to.y(), a.to.z()) < std::make_tuple(o.distance2, o.to.x(), o.to.y(), o.to.z());
  });
  return out;
}

double off(const Vector3d& to, const Vector3d& along) { return (to - to.dot(along) * along).norm(); }

/// Do the points within the tube's radius of the point itself lie on the line?
bool is_clear_here(const std::vector<Neighbour>& near, const Vector3d& along) {
  size_t beside = 0;
  for (const Neighbour& n : near) beside += off(n.to, along) > on_line;
  return static_cast<double>(beside) <= most_beside * static_cast<double>(near.size() + 1);
}

bool is_wire(const std::vector<Neighbour>& around, const Vector3d& along) {
  int on = 0, beside = 0;
  double first = 0.0, last = 0.0;
  for (const Neighbour& n : around) {
    const double away = off(n.to, along);
    if (away > clear_tube) continue;
    if (away > on_line) {
      ++beside;
      continue;
    }
    ++on;
    first = std::min(first, n.to.dot(along));
    last = std::max(last, n.to.dot(along));
  }
  return on >= fewest && last - first >= shortest && beside <= most_beside * (on + beside + 1);
}

/// Does `good` hold for a line through the point and one of its neighbours?
template <class Good>
bool any_line(const std::vector<Neighbour>& around, Good&& good) {
  return std::any_of(around.begin(), around.end(), [&](const Neighbour& n) {
    if (n.distance2 < least_baseline * least_baseline) return false;
    const Vector3d along = n.to / std::sqrt(n.distance2);
    return std::abs(along.z()) <= steepest && good(along);
  });
}

}  // namespace

double wire_points_halo() { return 2.0 * reach; }

std::vector<std::uint8_t> wire_points(const core::Block& b, const std::vector<std::uint8_t>& candidate) {
  std::vector<std::uint8_t> in_line(b.size(), 0), wire(b.size(), 0);
  if (b.size() == 0) return wire;
  const auto takes_part = [&](size_t p) { return candidate[p] != 0; };
  const Bins close(b, clear_tube, 1, takes_part), wide(b, reach, 1, takes_part);
  for (size_t p = 0; p < b.size(); ++p) {
    if (!candidate[p]) continue;
    const std::vector<Neighbour> near = within(close, b, p, clear_tube);
    // A crowd that no line through the point holds together: foliage. Most points end here.
    const bool may = near.size() < fewest || std::any_of(near.begin(), near.end(), [&](const Neighbour& n) {
                       return is_clear_here(near, n.to / std::sqrt(n.distance2));
                     });
    if (!may) continue;
    std::vector<Neighbour> around = within(wide, b, p, reach);
    if (around.size() < fewest) continue;
    if (around.size() > most_nearest) around.resize(most_nearest);
    in_line[p] = any_line(around, [&](const Vector3d& along) { return is_clear_here(near, along) && is_wire(around, along); });
  }
  // By chance foliage is in line at a point, not along a wire; and at the end of a wire there are too few points to tell by.
  const Bins lines(b, reach, 1, [&](size_t p) { return in_line[p] != 0; });
  for (size_t p = 0; p < b.size(); ++p) {
    if (!candidate[p]) continue;
    const std::vector<Neighbour> around = within(lines, b, p, reach);
    if (around.size() < fewest_in_line) continue;
    const std::vector<Neighbour> near = within(close, b, p, clear_tube);
    wire[p] = any_line(around, [&](const Vector3d& along) {
      const auto on = std::count_if(around.begin(), around.end(), [&](const Neighbour& n) { return off(n.to, along) <= on_line; });
      return on >= static_cast<std::ptrdiff_t>(fewest_in_line) && is_clear_here(near, along);
    });
  }
  return wire;
}

}  // namespace swath::filters
