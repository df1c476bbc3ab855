// SPDX-License-Identifier: GPL-3.0-or-later
// The place q, were it a vertex, would replace the triangles whose circumcircles hold it (Watson 1981). The cell that it would take from a
// vertex v is the polygon of those triangles' centres around v, closed by the centres of the new triangles at v; its area is Sibson's
// weight. Areas are sums over edges of the hole: each edge (u, v) with the centre on its left and on its right gives one term to u and one
// to v.
#include "terrain/tin/natural_neighbours.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "terrain/tin/delaunay.h"
#include "terrain/tin/tin_surface.h"

namespace swath::terrain {
namespace {

struct Vec {
  double x, y;
};

double cross(Vec a, Vec b) { return a.x * b.y - a.y * b.x; }

/// Centre of the circle through the origin, a and b.
Vec centre_through_origin(Vec a, Vec b) {
  const double d = 2.0 * cross(a, b), aa = a.x * a.x + a.y * a.y, bb = b.x * b.x + b.y * b.y;
  return {(b.y * aa - a.y * bb) / d, (a.x * bb - b.x * aa) / d};
}

/// Weight of a vertex, and the ends of its part of the hole's border.
struct Share {
  std::int32_t vertex;
  double twice_area = 0.0;
  Vec from{0, 0}, to{0, 0};  ///< new centres at the border's edge that comes to the vertex and at the one that leaves it
};

/// Triangles whose circumcircles hold the place, in an order of their own; none where it is at a vertex, or where they reach the rim or a
/// breakline.
std::vector<std::int32_t> hole_at(const Tin& tin, std::int32_t triangle, double x, double y) {
  const auto holds = [&](std::int32_t t) {
    const Circumcircle c = circumcircle(tin, t);
    return (x - c.x) * (x - c.x) + (y - c.y) * (y - c.y) < c.radius * c.radius;
  };
  if (!holds(triangle)) return {};  // at a vertex
  std::vector<std::int32_t> hole{triangle};
  for (size_t n = 0; n < hole.size(); ++n)
    for (int k = 0; k < 3; ++k) {
      const std::int32_t other = tin.across[static_cast<size_t>(hole[n])][static_cast<size_t>(k)];
      if (other < 0) return {};
      if (std::find(hole.begin(), hole.end(), other) != hole.end() || !holds(other)) continue;
      const auto& v = tin.triangles[static_cast<size_t>(hole[n])];
      const std::pair<std::int32_t, std::int32_t> edge(
          std::minmax(v[static_cast<size_t>((k + 1) % 3)], v[static_cast<size_t>((k + 2) % 3)]));
      if (std::binary_search(tin.constrained.begin(), tin.constrained.end(), edge)) return {};
      hole.push_back(other);
    }
  std::sort(hole.begin(), hole.end(), [&](std::int32_t a, std::int32_t b) { return tin.is_before(a, b); });
  return hole;
}

std::vector<Share> shares_of(const Tin& tin, const std::vector<std::int32_t>& hole, double x, double y) {
  std::vector<Share> shares;
  const auto share = [&](std::int32_t v) -> Share& {
    const auto at = std::find_if(shares.begin(), shares.end(), [v](const Share& s) { return s.vertex == v; });
    if (at != shares.end()) return *at;
    shares.push_back(Share{v, 0.0, {0, 0}, {0, 0}});
    return shares.back();
  };
  const auto from_q = [&](std::int32_t v) { return Vec{tin.x[v] - x, tin.y[v] - y}; };
  for (const std::int32_t t : hole) {
    const auto& v = tin.triangles[static_cast<size_t>(t)];
    const Circumcircle circle = circumcircle(tin, t);
    const Vec left{circle.x - x, circle.y - y};
    const Vec p = from_q(v[0]), q = from_q(v[1]), r = from_q(v[2]);
    const bool turned = cross({q.x - p.x, q.y - p.y}, {r.x - p.x, r.y - p.y}) < 0.0;
    for (int k = 0; k < 3; ++k) {
      // The edge opposite vertex k with this triangle on its left.
      std::int32_t a = v[static_cast<size_t>((k + 1) % 3)], b = v[static_cast<size_t>((k + 2) % 3)];
      if (turned) std::swap(a, b);
      const std::int32_t other = tin.across[static_cast<size_t>(t)][static_cast<size_t>(k)];
      const bool inner = std::find(hole.begin(), hole.end(), other) != hole.end();
      if (inner && tin.is_before(other, t)) continue;  // was met from the other side
      Vec right;
      if (inner) {
        const Circumcircle c = circumcircle(tin, other);
        right = {c.x - x, c.y - y};
      } else {
        right = centre_through_origin(from_q(a), from_q(b));
        share(a).to = right;
        share(b).from = right;
      }
      const double term = cross(right, left);
      share(a).twice_area += term;
      share(b).twice_area -= term;
    }
  }
  std::sort(shares.begin(), shares.end(),
            [&](const Share& a, const Share& b) { return is_before(tin.place(a.vertex), tin.place(b.vertex)); });
  return shares;
}

}  // namespace

double NaturalNeighbours::height(std::int32_t triangle, double x, double y) const {
  const std::vector<std::int32_t> hole = hole_at(tin_, triangle, x, y);
  if (hole.empty()) return height_in(tin_, triangle, x, y);
  const std::vector<Share> shares = shares_of(tin_, hole, x, y);
  double sum = 0.0, total = 0.0;
  const double z0 = tin_.z[shares.front().vertex];
  for (const Share& s : shares) {
    const double area = s.twice_area + cross(s.from, s.to);
    total += area;
    sum += area * (tin_.z[s.vertex] - z0);
  }
  const double z = z0 + sum / total;
  return std::isfinite(z) ? z : height_in(tin_, triangle, x, y);
}

}  // namespace swath::terrain
