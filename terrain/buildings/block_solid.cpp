// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/buildings/block_solid.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <map>

namespace swath::terrain {
namespace {

using Eigen::Vector3d;

std::vector<Vector3d> lifted(const Ring& ring, double height) {
  std::vector<Vector3d> out;
  for (const Eigen::Vector2d& p : ring) out.emplace_back(p.x(), p.y(), height);
  return out;
}

void add_walls(const Ring& ring, double bottom, double top, Solid& out) {
  for (size_t k = 0; k < ring.size(); ++k) {
    const Eigen::Vector2d &a = ring[k], &b = ring[(k + 1) % ring.size()];
    out.push_back({Boundary::wall, {{{a.x(), a.y(), bottom}, {b.x(), b.y(), bottom}, {b.x(), b.y(), top}, {a.x(), a.y(), top}}}});
  }
}

}  // namespace

SolidFace level_face(const Outline& outline, double height, Boundary kind) {
  SolidFace out{kind, {lifted(outline.outer, height)}};
  for (const Ring& hole : outline.holes) out.rings.push_back(lifted(hole, height));
  return out;
}

Solid block_over(const Outline& outline, double bottom, double top) {
  if (!(top > bottom) || outline.outer.size() < 3) return {};
  Solid out{level_face(outline, bottom, Boundary::ground)};
  for (auto& ring : out[0].rings) std::reverse(ring.begin(), ring.end());
  add_walls(outline.outer, bottom, top, out);
  for (const Ring& hole : outline.holes) add_walls(hole, bottom, top, out);
  out.push_back(level_face(outline, top, Boundary::roof));
  return out;
}

bool is_closed(const Solid& solid) {
  using Edge = std::array<double, 6>;
  std::map<Edge, int> uses;
  for (const SolidFace& face : solid)
    for (const auto& ring : face.rings)
      for (size_t k = 0; k < ring.size(); ++k) {
        const Vector3d &a = ring[k], &b = ring[(k + 1) % ring.size()];
        ++uses[{a.x(), a.y(), a.z(), b.x(), b.y(), b.z()}];
      }
  return !uses.empty() && std::all_of(uses.begin(), uses.end(), [&](const auto& use) {
    const Edge& e = use.first;
    const auto back = uses.find({e[3], e[4], e[5], e[0], e[1], e[2]});
    return use.second == 1 && back != uses.end() && back->second == 1;
  });
}

double volume(const Solid& solid) {
  double out = 0.0;
  if (solid.empty()) return out;
  const Vector3d origin = solid[0].rings[0][0];
  for (const SolidFace& face : solid)
    for (const auto& ring : face.rings)
      for (size_t k = 1; k + 1 < ring.size(); ++k) out += (ring[0] - origin).dot((ring[k] - origin).cross(ring[k + 1] - origin)) / 6.0;
  return out;
}

}  // namespace swath::terrain
