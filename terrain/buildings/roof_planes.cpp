// SPDX-License-Identifier: GPL-3.0-or-later
// Surface growing (Vosselman et al. 2004) over the edges of the roof's triangulation: planes that are one in space but apart on the roof
// stay apart, and the result depends on no draw. Seeds are planes through a return's neighbours and their neighbours, the flattest first;
// a plane is fitted anew each time that its returns have become a third more. Deviation: no Hough transform for seeds.
#include "terrain/buildings/roof_planes.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace swath::terrain {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double steepest = 3.73;      // rise / run: 75 deg
constexpr size_t fewest = 6;           // returns of a plane
constexpr double seed_rms = 0.5;       // of the tolerance
constexpr double growth = 1.33;        // of the returns, until the plane is fitted again
constexpr double level_slope = 0.005;  // below: no aspect

class Growth {
 public:
  Growth(const Tin& tin, const TrianglePart& part, const RoofPlaneOptions& o) : tin_(tin), part_(part), o_(o) {
    out_.plane.assign(tin.x.size(), -1);
    neighbours_.resize(tin.x.size());
    double area = 0.0;
    for (const std::int32_t t : part) {
      const auto& v = tin.triangles[index(t)];
      for (size_t k = 0; k < 3; ++k)
        for (const size_t other : {(k + 1) % 3, (k + 2) % 3}) neighbours_[index(v[k])].push_back(v[other]);
      area += area_of(t);
    }
    for (std::int32_t v = 0; v < static_cast<std::int32_t>(tin.x.size()); ++v) {
      auto& n = neighbours_[index(v)];
      std::sort(n.begin(), n.end());
      n.erase(std::unique(n.begin(), n.end()), n.end());
      if (!n.empty()) vertices_.push_back(v);
    }
    const double spacing2 = area / static_cast<double>(std::max<size_t>(1, vertices_.size()));
    least_ = std::max(fewest, static_cast<size_t>(0.5 * o.least_area / spacing2));
  }

  RoofPlanes grow() {
    for (const std::int32_t seed : seeds())
      if (out_.plane[index(seed)] < 0) grow_from(seed);
    settle();
    judge();
    return std::move(out_);
  }

 private:
  static size_t index(std::int32_t v) { return static_cast<size_t>(v); }
  Vector2d at(std::int32_t v) const { return {tin_.x[index(v)], tin_.y[index(v)]}; }
  double area_of(std::int32_t t) const {
    const auto& v = tin_.triangles[index(t)];
    const Vector2d a = at(v[1]) - at(v[0]), b = at(v[2]) - at(v[0]);
    return 0.5 * std::abs(a.x() * b.y() - a.y() * b.x());
  }
  double off(const RoofPlane& p, std::int32_t v) const {
    return (tin_.z[index(v)] - p.height(at(v))) / std::sqrt(1.0 + p.slope.squaredNorm());
  }

  /// By least squares of heights; false where the places lie on a line or the plane is too steep.
  bool fit(const std::vector<std::int32_t>& on, RoofPlane& p) const {
    const double n = static_cast<double>(on.size());
    Vector2d middle = Vector2d::Zero();
    double level = 0.0;
    for (const std::int32_t v : on) middle += at(v) / n, level += tin_.z[index(v)] / n;
    double xx = 0, xy = 0, yy = 0, xz = 0, yz = 0;
    for (const std::int32_t v : on) {
      const Vector2d d = at(v) - middle;
      const double z = tin_.z[index(v)] - level;
      xx += d.x() * d.x(), xy += d.x() * d.y(), yy += d.y() * d.y(), xz += d.x() * z, yz += d.y() * z;
    }
    const double det = xx * yy - xy * xy;
    if (on.size() < 3 || !(det > 1e-6 * (xx + yy) * (xx + yy))) return false;
    p.at = middle, p.level = level;
    p.slope = Vector2d(xz * yy - yz * xy, yz * xx - xz * xy) / det;
    double squares = 0.0;
    for (const std::int32_t v : on) squares += off(p, v) * off(p, v);
    p.rms = std::sqrt(squares / n), p.returns = on.size();
    return p.slope.norm() <= steepest;
  }

  std::vector<std::int32_t> around(std::int32_t v) const {
    std::vector<std::int32_t> out{v};
    for (const std::int32_t n : neighbours_[index(v)]) {
      out.push_back(n);
      out.insert(out.end(), neighbours_[index(n)].begin(), neighbours_[index(n)].end());
    }
    std::sort(out.begin(), out.end());
    out.erase(std::unique(out.begin(), out.end()), out.end());
    return out;
  }

  /// The flattest surroundings first.
  std::vector<std::int32_t> seeds() const {
    std::vector<std::pair<double, std::int32_t>> sorted;
    for (const std::int32_t v : vertices_) {
      RoofPlane p;
      const std::vector<std::int32_t> near = around(v);
      if (near.size() >= fewest && fit(near, p) && p.rms <= seed_rms * o_.tolerance) sorted.emplace_back(p.rms, v);
    }
    std::sort(sorted.begin(), sorted.end());
    std::vector<std::int32_t> out;
    for (const auto& [rms, v] : sorted) out.push_back(v);
    return out;
  }

  void grow_from(std::int32_t seed) {
    std::vector<std::int32_t> on = around(seed);
    std::erase_if(on, [&](std::int32_t v) { return out_.plane[index(v)] >= 0; });
    RoofPlane p;
    if (on.size() < fewest || !fit(on, p) || p.rms > seed_rms * o_.tolerance) return;
    const auto mine = static_cast<std::int32_t>(out_.planes.size());
    on.clear();
    for (int round = 0; round < 2; ++round) {  // the second from the plane of the first
      mark(on, -1);
      on = connected(p, seed, mine, round == 0);
      if (on.size() >= least_ && fit(on, p)) continue;
      mark(on, -1);
      return;
    }
    out_.planes.push_back(p);
  }

  void mark(const std::vector<std::int32_t>& on, std::int32_t plane) {
    for (const std::int32_t v : on) out_.plane[index(v)] = plane;
  }

  /// Free vertices within the tolerance that edges join to `from`, marked; `refit`: of the plane while it grows.
  std::vector<std::int32_t> connected(RoofPlane& p, std::int32_t from, std::int32_t mine, bool refit) {
    std::vector<std::int32_t> on{from};
    out_.plane[index(from)] = mine;
    size_t next_fit = 2 * fewest;
    for (size_t k = 0; k < on.size(); ++k) {
      for (const std::int32_t n : neighbours_[index(on[k])])
        if (out_.plane[index(n)] < 0 && std::abs(off(p, n)) <= o_.tolerance) out_.plane[index(n)] = mine, on.push_back(n);
      if (!refit || on.size() < next_fit) continue;
      RoofPlane better;
      if (fit(on, better)) p = better;
      next_fit = static_cast<size_t>(growth * static_cast<double>(on.size())) + 1;
    }
    return on;
  }

  /// Vertices where planes meet belong to the nearest of those around them.
  void settle() {
    std::vector<std::int32_t> better = out_.plane;
    for (const std::int32_t v : vertices_) {
      double least = out_.plane[index(v)] < 0 ? o_.tolerance : std::abs(off(out_.planes[index(out_.plane[index(v)])], v));
      for (const std::int32_t n : neighbours_[index(v)]) {
        const std::int32_t other = out_.plane[index(n)];
        if (other < 0) continue;
        if (const double d = std::abs(off(out_.planes[index(other)], v)); d < least) least = d, better[index(v)] = other;
      }
    }
    out_.plane = std::move(better);
  }

  /// Fits planes for the last time, measures them, drops small ones and puts the largest first.
  void judge() {
    std::vector<std::vector<std::int32_t>> on(out_.planes.size());
    for (const std::int32_t v : vertices_)
      if (out_.plane[index(v)] >= 0) on[index(out_.plane[index(v)])].push_back(v);
    std::vector<double> area(out_.planes.size(), 0.0);
    for (const std::int32_t t : part_)
      if (const std::int32_t p = plane_of(tin_, t, out_); p >= 0) area[index(p)] += area_of(t);
    std::vector<size_t> order;
    for (size_t k = 0; k < on.size(); ++k) {
      out_.planes[k].area = area[k];
      if (area[k] >= o_.least_area && on[k].size() >= fewest && fit(on[k], out_.planes[k])) order.push_back(k);
    }
    std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return area[a] > area[b]; });
    std::vector<std::int32_t> number(on.size(), -1);
    std::vector<RoofPlane> kept;
    for (const size_t k : order) number[k] = static_cast<std::int32_t>(kept.size()), kept.push_back(out_.planes[k]);
    for (std::int32_t& p : out_.plane)
      if (p >= 0) p = number[index(p)];
    out_.planes = std::move(kept);
  }

  const Tin& tin_;
  const TrianglePart& part_;
  const RoofPlaneOptions& o_;
  std::vector<std::vector<std::int32_t>> neighbours_;
  std::vector<std::int32_t> vertices_;
  size_t least_ = fewest;
  RoofPlanes out_;
};

}  // namespace

double RoofPlane::aspect() const {
  if (slope.norm() < level_slope) return std::numeric_limits<double>::quiet_NaN();
  const double a = std::atan2(-slope.x(), -slope.y());
  return a < 0.0 ? a + 2.0 * M_PI : a;
}

RoofPlanes roof_planes(const Tin& tin, const TrianglePart& part, const RoofPlaneOptions& o) { return Growth(tin, part, o).grow(); }

std::int32_t plane_of(const Tin& tin, std::int32_t triangle, const RoofPlanes& planes) {
  const auto& v = tin.triangles[static_cast<size_t>(triangle)];
  const auto of = [&](size_t k) { return planes.plane[static_cast<size_t>(v[k])]; };
  if (of(0) == of(1) || of(0) == of(2)) return of(0);
  return of(1) == of(2) ? of(1) : -1;
}

}  // namespace swath::terrain
