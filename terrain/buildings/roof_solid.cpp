// SPDX-License-Identifier: GPL-3.0-or-later
// A roof without valleys is the lower envelope of its planes: the piece of a plane is the outline, clipped to where the plane is the lowest
// (Sutherland & Hodgman 1974, of a convex polygon). Pieces share their corners, for both sides of an edge are clipped by the same numbers.
#include "terrain/buildings/roof_solid.h"

#include <algorithm>
#include <cmath>

namespace swath::terrain {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double least_on_lowest = 0.9;
constexpr double least_wall = 0.5;  // m
constexpr double snap = 1e-4;       // m

bool runs_inwards(const Ring& ring) {
  for (size_t k = 0; k < ring.size(); ++k) {
    const Vector2d &a = ring[k], &b = ring[(k + 1) % ring.size()], &c = ring[(k + 2) % ring.size()];
    if ((b - a).x() * (c - b).y() - (b - a).y() * (c - b).x() <= 0.0) return true;
  }
  return false;
}

/// Where plane `a` is not above plane `b`; of equal ones the first has all.
Ring clipped(const Ring& ring, const RoofPlane& a, const RoofPlane& b, bool is_first) {
  Ring out;
  const auto above = [&](const Vector2d& p) { return a.height(p) - b.height(p); };
  if ((a.slope - b.slope).norm() < 1e-9) return above(ring[0]) < 0.0 || (above(ring[0]) == 0.0 && is_first) ? ring : out;
  for (size_t k = 0; k < ring.size(); ++k) {
    const Vector2d &p = ring[k], &q = ring[(k + 1) % ring.size()];
    const double at_p = above(p), at_q = above(q);
    if (at_p <= 0.0) out.push_back(p);
    if (at_p * at_q < 0.0) out.push_back(p + at_p / (at_p - at_q) * (q - p));
  }
  return out;
}

Vector3d snapped(const Vector2d& p, double z) {
  return {std::round(p.x() / snap) * snap, std::round(p.y() / snap) * snap, std::round(z / snap) * snap};
}

std::vector<Vector3d> without_doubles(std::vector<Vector3d> ring) {
  ring.erase(std::unique(ring.begin(), ring.end()), ring.end());
  while (ring.size() > 1 && ring.front() == ring.back()) ring.pop_back();
  return ring;
}

/// The wall over the side from a to b, up to those corners of the roof that lie on it.
SolidFace wall_over(const Vector2d& a, const Vector2d& b, double bottom, const std::vector<std::pair<Vector2d, double>>& corners) {
  const Vector2d side = b - a;
  const double length = side.norm();
  std::vector<std::pair<double, Vector3d>> top;
  for (const auto& [p, z] : corners) {
    const double along = (p - a).dot(side) / length, off = std::abs(side.x() * (p - a).y() - side.y() * (p - a).x()) / length;
    if (off < 1e-7 && along > -1e-7 && along < length + 1e-7) top.emplace_back(-along, snapped(p, z));
  }
  std::sort(top.begin(), top.end(), [](const auto& p, const auto& q) { return p.first < q.first; });
  std::vector<Vector3d> ring{snapped(a, bottom), snapped(b, bottom)};
  for (const auto& [along, p] : top) ring.push_back(p);
  return {Boundary::wall, {without_doubles(std::move(ring))}};
}

}  // namespace

Solid roof_solid(const Building& b, double bottom) {
  const Ring& outline = b.outline.outer;
  if (!std::isfinite(bottom) || outline.size() < 3 || !b.outline.holes.empty() || runs_inwards(outline)) return {};
  if (b.planes.empty() || b.planes.size() > most_solid_planes || b.on_lowest < least_on_lowest) return {};
  Solid out{{Boundary::ground, {{}}}};
  for (size_t k = outline.size(); k-- > 0;) out[0].rings[0].push_back(snapped(outline[k], bottom));
  std::vector<std::pair<Vector2d, double>> corners;
  for (size_t i = 0; i < b.planes.size(); ++i) {
    Ring piece = outline;
    for (size_t j = 0; j < b.planes.size() && piece.size() >= 3; ++j)
      if (j != i) piece = clipped(piece, b.planes[i], b.planes[j], i < j);
    std::vector<Vector3d> ring;
    for (const Vector2d& p : piece) {
      const double z = b.planes[i].height(p);
      if (z < bottom + least_wall) return {};
      corners.emplace_back(p, z);
      ring.push_back(snapped(p, z));
    }
    ring = without_doubles(std::move(ring));
    if (ring.size() >= 3) out.push_back({Boundary::roof, {std::move(ring)}});
  }
  for (size_t k = 0; k < outline.size(); ++k) out.push_back(wall_over(outline[k], outline[(k + 1) % outline.size()], bottom, corners));
  if (!is_closed(out) || !(volume(out) > 0.0)) return {};
  return out;
}

}  // namespace swath::terrain
