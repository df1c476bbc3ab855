// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/ties/tie_returns.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

namespace swath::calib {

using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

constexpr double spare = 1.5;  // times the wanted returns: some will not lie on the plane

std::int32_t along(const CellIndex3& c, int axis) { return axis == 0 ? c.i : axis == 1 ? c.j : c.k; }
std::int32_t& along(CellIndex3& c, int axis) { return axis == 0 ? c.i : axis == 1 ? c.j : c.k; }

// The axis a plane is a graph over.
int steepest(const Vector3d& normal) {
  int axis = 0;
  normal.cwiseAbs().maxCoeff(&axis);
  return axis;
}

// Cells that a region's slab may touch.
std::vector<CellIndex3> cells_of(const PlaneRegion& r, double side) {
  std::vector<CellIndex3> out;
  if (!r.cells.empty()) {
    const int a = steepest(r.normal), b = (a + 1) % 3, c = (a + 2) % 3;
    const double thick = r.reach / std::abs(r.normal[a]);
    for (const CellIndex3& cell : r.cells) {
      double low = std::numeric_limits<double>::infinity(), high = -low;
      for (int corner = 0; corner < 4; ++corner) {
        const double pb = (along(cell, b) + (corner & 1)) * side - r.centre[b], pc = (along(cell, c) + (corner >> 1)) * side - r.centre[c];
        const double at = r.centre[a] - (r.normal[b] * pb + r.normal[c] * pc) / r.normal[a];
        low = std::min(low, at - thick), high = std::max(high, at + thick);
      }
      CellIndex3 here = cell;
      for (auto k = static_cast<std::int32_t>(std::floor(low / side)); k <= static_cast<std::int32_t>(std::floor(high / side)); ++k) {
        along(here, a) = k;
        out.push_back(here);
      }
    }
  } else {
    const auto axes = plane_axes(r.normal);
    Vector3d low = Vector3d::Constant(std::numeric_limits<double>::infinity()), high = -low;
    for (const Vector2d& q : r.outline)
      for (const double sign : {-1.0, 1.0}) {
        const Vector3d p = r.centre + q.x() * axes[0] + q.y() * axes[1] + sign * r.reach * r.normal;
        low = low.cwiseMin(p), high = high.cwiseMax(p);
      }
    const CellIndex3 first = cell_of(low.x(), low.y(), low.z(), side), last = cell_of(high.x(), high.y(), high.z(), side);
    for (std::int32_t i = first.i; i <= last.i; ++i)
      for (std::int32_t j = first.j; j <= last.j; ++j)
        for (std::int32_t k = first.k; k <= last.k; ++k)
          if (std::abs(r.normal.dot(centre_of({i, j, k}, side) - r.centre)) < r.reach + side) out.push_back({i, j, k});
  }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

// Cell -> regions: one open table of the cells, one list of the regions.
class RegionIndex {
 public:
  RegionIndex(const std::vector<PlaneRegion>& regions, double side) {
    std::vector<std::pair<std::uint64_t, std::uint32_t>> all;
    for (std::uint32_t r = 0; r < regions.size(); ++r)
      for (const CellIndex3& c : cells_of(regions[r], side)) all.emplace_back(key_of(c), r);
    std::sort(all.begin(), all.end());
    slots_.assign(std::bit_ceil(std::max<size_t>(4 * all.size(), 1024)), {});
    for (size_t first = 0, end = 0; first < all.size(); first = end) {
      size_t slot = mixed(all[first].first) & (slots_.size() - 1);
      while (slots_[slot].end != 0) slot = (slot + 1) & (slots_.size() - 1);
      const auto begin = static_cast<std::uint32_t>(regions_.size());
      for (end = first; end < all.size() && all[end].first == all[first].first; ++end) regions_.push_back(all[end].second);
      slots_[slot] = {all[first].first, begin, static_cast<std::uint32_t>(regions_.size())};
    }
  }
  /// [begin, end) of the list.
  std::pair<const std::uint32_t*, const std::uint32_t*> at(const CellIndex3& c) const {
    const std::uint64_t key = key_of(c);
    size_t slot = mixed(key) & (slots_.size() - 1);
    while (slots_[slot].end != 0 && slots_[slot].key != key) slot = (slot + 1) & (slots_.size() - 1);
    return {regions_.data() + slots_[slot].begin, regions_.data() + slots_[slot].end};
  }

 private:
  struct Slot {
    std::uint64_t key = 0;
    std::uint32_t begin = 0, end = 0;  // end 0: free
  };
  std::vector<Slot> slots_;
  std::vector<std::uint32_t> regions_;
};

}  // namespace

bool is_inside(const std::vector<Vector2d>& polygon, const Vector2d& p, double margin) {
  bool inside = false;
  for (size_t k = 0; k < polygon.size(); ++k) {
    const Vector2d &a = polygon[k], &b = polygon[(k + 1) % polygon.size()], way = b - a;
    if ((a.y() > p.y()) != (b.y() > p.y()) && p.x() < a.x() + way.x() * (p.y() - a.y()) / way.y()) inside = !inside;
    const double length2 = way.squaredNorm(), t = length2 > 0.0 ? std::clamp(way.dot(p - a) / length2, 0.0, 1.0) : 0.0;
    if ((p - a - t * way).norm() < margin) return false;
  }
  return inside;
}

std::vector<std::vector<NearReturn>> collect_returns(const ShotStream& stream, LocalPoints& points, const std::vector<PlaneRegion>& regions,
                                                     double side, const std::vector<TieLine>& lines) {
  std::vector<std::vector<NearReturn>> out(regions.size());
  const RegionIndex index(regions, side);
  // Highest draw that is kept, by region and line.
  constexpr std::uint64_t everything = std::numeric_limits<std::uint64_t>::max();
  const auto limit_of = [&](std::uint32_t n, std::uint32_t wanted) {
    const double share = spare * wanted / std::max(n, 1u);
    return share >= 1.0 ? everything : static_cast<std::uint64_t>(share * 18446744073709549568.0);
  };
  std::vector<std::vector<std::uint64_t>> limits(regions.size());
  for (size_t r = 0; r < regions.size(); ++r) {
    std::uint32_t largest = 0;
    for (const FacetLook& l : regions[r].looks) largest = std::max(largest, l.n);
    limits[r].assign(lines.size(), limit_of(largest, regions[r].wanted));
    std::vector<std::uint32_t> of(lines.size(), 0);
    for (const FacetLook& l : regions[r].looks) of[l.line] = std::max(of[l.line], l.n);
    for (size_t l = 0; l < lines.size(); ++l)
      if (of[l] > 0) limits[r][l] = limit_of(of[l], regions[r].wanted);
  }
  std::vector<std::array<Vector3d, 2>> axes;
  for (const PlaneRegion& r : regions) axes.push_back(plane_axes(r.normal));

  stream_points(stream, points, {}, [&](int id, const core::Shots& shots, const PointColumns& p) {
    const auto at = std::lower_bound(lines.begin(), lines.end(), id, [](const TieLine& l, int x) { return l.id < x; });
    if (at == lines.end() || at->id != id) return;
    const auto line = static_cast<std::uint32_t>(at - lines.begin());
    for (size_t i = 0; i < shots.size(); ++i) {
      if (std::isnan(p.x[i]) || !is_last_return(shots, i)) continue;
      const auto [begin, end] = index.at(cell_of(p.x[i], p.y[i], p.z[i], side));
      for (const std::uint32_t* r = begin; r != end; ++r) {
        const PlaneRegion& region = regions[*r];
        const Vector3d away = Vector3d(p.x[i], p.y[i], p.z[i]) - region.centre;
        if (std::abs(region.normal.dot(away)) > region.reach) continue;
        const std::uint64_t draw =
            mixed(std::bit_cast<std::uint64_t>(shots.time[i]) * 0x9e3779b97f4a7c15ull ^ std::bit_cast<std::uint64_t>(shots.range[i]));
        if (draw > limits[*r][line]) continue;
        if (region.cells.empty() && !is_inside(region.outline, {axes[*r][0].dot(away), axes[*r][1].dot(away)}, region.margin)) continue;
        out[*r].push_back({shots.time[i], shots.angle[i], shots.forward.empty() ? 0.0 : shots.forward[i], shots.range[i],
                           away.cast<float>(), line, draw});
      }
    }
  });
  return out;
}

}  // namespace swath::calib
