// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/buildings/roof_heights.h"

#include <algorithm>
#include <map>

namespace swath::terrain {
namespace {

using Eigen::Vector2d;

constexpr double edge_step = 0.5, ground_step = 1.0, bucket = 2.0;  // m
constexpr double eaves_share = 0.1;                                 // of the outline, that may lie lower
constexpr int farthest_bucket = 3;

double share_of(std::vector<double> values, double share) {
  if (values.empty()) return Building::none;
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<size_t>(at)];
}

/// The plane at places near the roof.
class NearestPlane {
 public:
  NearestPlane(const Tin& tin, const RoofPlanes& roof) : tin_(tin), roof_(roof) {
    for (size_t v = 0; v < tin.x.size(); ++v)
      if (roof.plane[v] >= 0) buckets_[of(tin.x[v], tin.y[v])].push_back(v);
  }
  /// Null where there is none within some metres.
  const RoofPlane* at(const Vector2d& p) const {
    const auto [i, j] = of(p.x(), p.y());
    double least = 1e300;
    const RoofPlane* found = nullptr;
    for (int ring = 0; ring <= farthest_bucket; ++ring) {
      for (std::int64_t u = i - ring; u <= i + ring; ++u)
        for (std::int64_t w = j - ring; w <= j + ring; ++w) {
          if (std::max(std::abs(u - i), std::abs(w - j)) != ring) continue;
          const auto here = buckets_.find({u, w});
          if (here == buckets_.end()) continue;
          for (const size_t v : here->second) {
            const double d = (Vector2d(tin_.x[v], tin_.y[v]) - p).squaredNorm();
            if (d < least) least = d, found = &roof_.planes[static_cast<size_t>(roof_.plane[v])];
          }
        }
      if (found && std::sqrt(least) <= ring * bucket) break;
    }
    return found;
  }

 private:
  static std::pair<std::int64_t, std::int64_t> of(double x, double y) {
    return {static_cast<std::int64_t>(std::floor(x / bucket)), static_cast<std::int64_t>(std::floor(y / bucket))};
  }
  const Tin& tin_;
  const RoofPlanes& roof_;
  std::map<std::pair<std::int64_t, std::int64_t>, std::vector<size_t>> buckets_;
};

/// The highest place of the planes where two meet between two neighbours, and at returns all of whose neighbours lie on the same plane: the
/// plane of one that noise has put on the wrong side of a ridge is too high there.
double highest(const Tin& tin, const RoofPlanes& roof) {
  std::vector<std::uint8_t> between(tin.x.size(), 0);
  const auto for_each_edge = [&](auto&& f) {
    for (const auto& triangle : tin.triangles)
      for (size_t k = 0; k < 3; ++k) f(static_cast<size_t>(triangle[k]), static_cast<size_t>(triangle[(k + 1) % 3]));
  };
  double out = -1e300;
  for_each_edge([&](size_t v, size_t w) {
    if (roof.plane[v] == roof.plane[w] || roof.plane[v] < 0 || roof.plane[w] < 0) return;
    between[v] = between[w] = 1;
    const RoofPlane &a = roof.planes[static_cast<size_t>(roof.plane[v])], &b = roof.planes[static_cast<size_t>(roof.plane[w])];
    const Vector2d p(tin.x[v], tin.y[v]), q(tin.x[w], tin.y[w]);
    const double at_p = a.height(p) - b.height(p), at_q = a.height(q) - b.height(q);
    if (at_p * at_q < 0.0) out = std::max(out, a.height(p + at_p / (at_p - at_q) * (q - p)));
  });
  for (size_t v = 0; v < tin.x.size(); ++v)
    if (roof.plane[v] >= 0 && !between[v])
      out = std::max(out, roof.planes[static_cast<size_t>(roof.plane[v])].height({tin.x[v], tin.y[v]}));
  return out > -1e300 ? out : Building::none;
}

double share_on_planes(const Tin& tin, const RoofPlanes& roof) {
  double on = 0.0, all = 0.0;
  for (std::int32_t t = 0; t < static_cast<std::int32_t>(tin.size()); ++t) {
    const auto& v = tin.triangles[static_cast<size_t>(t)];
    const auto at = [&](size_t k) { return Vector2d(tin.x[static_cast<size_t>(v[k])], tin.y[static_cast<size_t>(v[k])]); };
    const Vector2d a = at(1) - at(0), b = at(2) - at(0);
    const double area = 0.5 * std::abs(a.x() * b.y() - a.y() * b.x());
    all += area;
    if (plane_of(tin, t, roof) >= 0) on += area;
  }
  return all > 0.0 ? on / all : 0.0;
}

void measure_ground(const std::function<double(const Vector2d&)>& ground, Building& b) {
  for (const double away : {1.0, 3.0, 6.0}) {  // farther where the model has none at the wall
    double sum = 0.0, n = 0.0, lowest = 1e300;
    for_each_place(b.outline.outer, ground_step, [&](const Vector2d& p, const Vector2d& right) {
      const double z = ground(p + away * right);
      if (!std::isfinite(z)) return;
      sum += z, n += 1.0, lowest = std::min(lowest, z);
    });
    if (n == 0.0) continue;
    b.lowest_ground = lowest, b.mean_ground = sum / n;
    return;
  }
}

}  // namespace

void measure_heights(const Tin& tin, const RoofPlanes& roof, const std::function<double(const Vector2d&)>& ground, Building& b) {
  std::vector<double> on_planes;
  for (size_t v = 0; v < tin.x.size(); ++v)
    if (roof.plane[v] >= 0) on_planes.push_back(tin.z[v]);
  b.middle = share_of(on_planes.empty() ? tin.z : on_planes, 0.5);
  b.top = *std::max_element(tin.z.begin(), tin.z.end());
  b.explained = share_on_planes(tin, roof);
  b.ridge = highest(tin, roof);
  const NearestPlane nearest(tin, roof);
  std::vector<double> edge;
  for_each_place(b.outline.outer, edge_step, [&](const Vector2d& p, const Vector2d&) {
    if (const RoofPlane* plane = nearest.at(p)) edge.push_back(plane->height(p));
  });
  b.eaves = share_of(std::move(edge), eaves_share);
  b.ridge = std::max(b.ridge, b.eaves);
  measure_ground(ground, b);
}

}  // namespace swath::terrain
