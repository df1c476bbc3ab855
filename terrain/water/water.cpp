// SPDX-License-Identifier: GPL-3.0-or-later
// Hydro-flattening in the sense of Heidemann 2018, "Lidar base specification" (USGS TM 11-B4): still water level, double-line streams level
// from bank to bank and falling. Deviation: heights may come from the shore's own ground points.
// Sigma of a level from n shore points: their median sigma_v, and the half width between the quantiles q/2 and 2q, which says how well the
// shore shows where the water stands.
#include "terrain/water/water.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "core/distributions.h"
#include "terrain/water/area.h"
#include "terrain/water/river.h"

namespace swath::terrain {
namespace {

using Eigen::Vector3d;

constexpr double own_tolerance = 0.01;  // m: own heights that differ by more from the surface made of them are counted

/// The vertices of an outer ring by cells, for the nearest one.
class Shoreline {
 public:
  Shoreline(const std::vector<Vector3d>& ring, double reach) : ring_(ring), reach_(reach) {
    for (std::uint32_t k = 0; k < ring.size(); ++k) cells_[key(cell(ring[k].x()), cell(ring[k].y()))].push_back(k);
  }
  /// -1 where none is within reach.
  std::int64_t nearest(double x, double y) const {
    std::int64_t best = -1;
    double least = reach_ * reach_;
    for (std::int64_t j = cell(y) - 1; j <= cell(y) + 1; ++j)
      for (std::int64_t i = cell(x) - 1; i <= cell(x) + 1; ++i) {
        const auto at = cells_.find(key(i, j));
        if (at == cells_.end()) continue;
        for (const std::uint32_t k : at->second) {
          const double dx = ring_[k].x() - x, dy = ring_[k].y() - y, d = dx * dx + dy * dy;
          if (d < least || (d == least && best > k)) least = d, best = k;
        }
      }
    return best;
  }

 private:
  std::int64_t cell(double v) const { return static_cast<std::int64_t>(std::floor(v / reach_)); }
  static std::int64_t key(std::int64_t i, std::int64_t j) { return i * 0x100000000LL + (j & 0xffffffffLL); }
  const std::vector<Vector3d>& ring_;
  double reach_;
  std::unordered_map<std::int64_t, std::vector<std::uint32_t>> cells_;
};

std::vector<Vector3d> outer_ring(const core::Breakline& water, const WaterOptions& o) {
  return sampled_ring(water.parts.front(), 0.5 * o.shore.value);
}

void flatten_lake(core::Breakline& lake, double level) {
  for (auto& ring : lake.parts)
    for (Vector3d& v : ring) v.z() = level;
}

/// Level and its sigma.
std::pair<double, double> level_of(const std::vector<ShorePoint>& shores, double q) {
  std::vector<double> z, sigma;
  for (const ShorePoint& p : shores) {
    z.push_back(p.z);
    if (std::isfinite(p.sigma)) sigma.push_back(static_cast<double>(p.sigma));
  }
  std::sort(z.begin(), z.end());
  std::sort(sigma.begin(), sigma.end());
  const double own = sigma.empty() ? 0.0 : core::interpolated_quantile(sigma, 0.5);
  return {core::interpolated_quantile(z, q),
          std::hypot(own, 0.5 * (core::interpolated_quantile(z, std::min(0.5, 2.0 * q)) - core::interpolated_quantile(z, 0.5 * q)))};
}

/// Heights of islands' vertices: those of the nearest vertex of the outline.
void give_islands_heights(core::Breakline& river) {
  const std::vector<Vector3d>& outer = river.parts.front();
  for (size_t r = 1; r < river.parts.size(); ++r)
    for (Vector3d& v : river.parts[r]) {
      const auto near = std::min_element(outer.begin(), outer.end(), [&](const Vector3d& p, const Vector3d& q) {
        return (p - v).head<2>().squaredNorm() < (q - v).head<2>().squaredNorm();
      });
      v.z() = near->z();
    }
}

void flow_from_shores(core::Breakline& river, const std::vector<ShorePoint>& shores, const WaterOptions& o) {
  std::vector<Vector3d>& ring = river.parts.front();
  const Banks banks = banks_of(ring);
  // Rung and station of each vertex.
  std::vector<double> station(banks.rungs.size(), 0.0);
  for (size_t k = 1; k < banks.rungs.size(); ++k) {
    const auto [i0, j0] = banks.rungs[k - 1];
    const auto [i1, j1] = banks.rungs[k];
    station[k] = station[k - 1] + 0.5 * ((ring[banks.left[i1]] - ring[banks.left[i0]]).head<2>().norm() +
                                         (ring[banks.right[j1]] - ring[banks.right[j0]]).head<2>().norm());
  }
  std::vector<double> at_vertex(ring.size(), 0.0);
  for (size_t k = 0; k < banks.rungs.size(); ++k)
    for (const size_t v : {banks.left[banks.rungs[k].first], banks.right[banks.rungs[k].second]}) at_vertex[v] = station[k];
  std::vector<std::pair<double, ShorePoint>> along;
  for (const ShorePoint& p : shores) along.emplace_back(at_vertex[p.vertex], p);
  std::sort(along.begin(), along.end(),
            [](const auto& a, const auto& b) { return std::pair(a.first, a.second.z) < std::pair(b.first, b.second.z); });

  std::vector<double> level(banks.rungs.size(), 0.0), weight(banks.rungs.size(), 0.0);
  double variance = 0.0, n = 0.0;
  for (size_t k = 0; k < banks.rungs.size(); ++k) {
    const auto first = std::lower_bound(along.begin(), along.end(), station[k] - 0.5 * o.stretch.value,
                                        [](const auto& a, double s) { return a.first < s; });
    std::vector<ShorePoint> in;
    for (auto a = first; a != along.end() && a->first <= station[k] + 0.5 * o.stretch.value; ++a) in.push_back(a->second);
    if (in.empty()) continue;
    const auto [z, sigma] = level_of(in, o.quantile);
    level[k] = z;
    weight[k] = static_cast<double>(in.size());
    variance += sigma * sigma;
    n += 1.0;
  }
  river.sigma = std::sqrt(variance / n);
  level_across(ring, banks, level, weight);
}

}  // namespace

std::vector<ShorePoint> shore_points(const core::Block& b, const std::vector<std::uint32_t>& rows, size_t own,
                                     const std::vector<core::Breakline>& features, const WaterOptions& o) {
  std::vector<ShorePoint> out;
  double x0 = std::numeric_limits<double>::infinity(), y0 = x0, x1 = -x0, y1 = -x0;
  for (const std::uint32_t r : rows) {
    if (r >= own) continue;
    x0 = std::min(x0, b.x[r]);
    x1 = std::max(x1, b.x[r]);
    y0 = std::min(y0, b.y[r]);
    y1 = std::max(y1, b.y[r]);
  }
  for (std::uint32_t f = 0; f < features.size(); ++f) {
    const core::Breakline& water = features[f];
    if (!water.is_water() || water.has_height) continue;
    const Area area(water.parts);
    if (!area.box_meets(x0 - o.shore.value, y0 - o.shore.value, x1 + o.shore.value, y1 + o.shore.value)) continue;
    const std::vector<Vector3d> ring = outer_ring(water, o);
    const Shoreline line(ring, o.shore.value);
    for (const std::uint32_t r : rows) {
      if (r >= own || !std::isfinite(b.z[r])) continue;
      const std::int64_t v = line.nearest(b.x[r], b.y[r]);
      if (v < 0 || area.holds(b.x[r], b.y[r])) continue;
      out.push_back({f, static_cast<std::uint32_t>(v), b.z[r], b.sigma_v.empty() ? std::nanf("") : b.sigma_v[r]});
    }
  }
  return out;
}

core::Breakline with_heights(const core::Breakline& water, std::vector<ShorePoint> shores, const WaterOptions& o, core::Tally& tally) {
  core::Breakline out = water;
  if (!water.has_height && shores.empty()) {
    tally.count("waters without a height and without ground points at their shore: left void", water.place);
    return out;
  }
  std::sort(shores.begin(), shores.end(),
            [](const ShorePoint& a, const ShorePoint& b) { return std::tie(a.vertex, a.z, a.sigma) < std::tie(b.vertex, b.z, b.sigma); });
  out.has_height = true;
  if (water.kind == core::BreaklineKind::lake) {
    double level = 0.0;
    if (water.has_height) {
      std::vector<double> z;
      for (const Vector3d& v : water.parts.front()) z.push_back(v.z());
      level = core::interpolated_quantile(z, 0.5);
      if (const auto [low, high] = std::minmax_element(z.begin(), z.end()); *high - *low > own_tolerance)
        tally.count("lakes whose vertices differ in height: their median is the level", water.place);
    } else {
      std::tie(level, out.sigma) = level_of(shores, o.quantile);
    }
    flatten_lake(out, level);
    return out;
  }
  out.parts.front() = outer_ring(water, o);
  if (water.has_height) {
    const std::vector<Vector3d> before = out.parts.front();
    make_banks_fall(out.parts.front(), banks_of(before));
    bool mended = false;
    for (size_t k = 0; k < before.size(); ++k) mended = mended || std::abs(before[k].z() - out.parts.front()[k].z()) > own_tolerance;
    if (mended) tally.count("rivers whose banks rise somewhere along the flow: mended", water.place);
  } else {
    flow_from_shores(out, shores, o);
  }
  if (!water.has_height) give_islands_heights(out);
  return out;
}

}  // namespace swath::terrain
