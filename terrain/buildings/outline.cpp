// SPDX-License-Identifier: GPL-3.0-or-later
// The rim of Delaunay triangles with a bounded circumradius is an alpha shape (Edelsbrunner, Kirkpatrick & Seidel 1983).
#include "terrain/buildings/outline.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/ring.h"

namespace swath::terrain {
namespace {

using Eigen::Vector2d;

Vector2d place_of(const Tin& tin, std::int32_t v) { return {tin.x[static_cast<size_t>(v)], tin.y[static_cast<size_t>(v)]}; }

double side_of(const Vector2d& a, const Vector2d& b, const Vector2d& p) { return (b - a).x() * (p - a).y() - (b - a).y() * (p - a).x(); }

/// Do the sides from a to b and from c to d have a place in common?
bool do_meet(const Vector2d& a, const Vector2d& b, const Vector2d& c, const Vector2d& d) {
  const double ac = side_of(a, b, c), ad = side_of(a, b, d), ca = side_of(c, d, a), cb = side_of(c, d, b);
  if ((ac > 0.0 && ad > 0.0) || (ac < 0.0 && ad < 0.0) || (ca > 0.0 && cb > 0.0) || (ca < 0.0 && cb < 0.0)) return false;
  const auto beyond = [](double p, double q, double s, double t) {
    return std::max(p, q) < std::min(s, t) || std::max(s, t) < std::min(p, q);
  };
  return !beyond(a.x(), b.x(), c.x(), d.x()) && !beyond(a.y(), b.y(), c.y(), d.y());
}

bool do_meet(const Ring& a, const Ring& b) {
  for (size_t i = 0; i < a.size(); ++i)
    for (size_t j = 0; j < b.size(); ++j)
      if (do_meet(a[i], a[(i + 1) % a.size()], b[j], b[(j + 1) % b.size()])) return true;
  return false;
}

/// Edges of the part that have none of it on their right, by their first vertex.
std::multimap<std::int32_t, std::int32_t> rim_edges(const Tin& tin, const TrianglePart& part) {
  std::multimap<std::int32_t, std::int32_t> out;
  for (const std::int32_t t : part) {
    const auto& v = tin.triangles[static_cast<size_t>(t)];
    const bool left = side_of(place_of(tin, v[0]), place_of(tin, v[1]), place_of(tin, v[2])) > 0.0;
    for (size_t k = 0; k < 3; ++k) {
      const std::int32_t other = tin.across[static_cast<size_t>(t)][k];
      if (other >= 0 && std::binary_search(part.begin(), part.end(), other)) continue;
      const std::int32_t a = v[(k + 1) % 3], b = v[(k + 2) % 3];
      left ? out.emplace(a, b) : out.emplace(b, a);
    }
  }
  return out;
}

/// The edges as simple rings of vertices: a path that comes back to one of its vertices is cut off there.
std::vector<std::vector<std::int32_t>> rings_of(std::multimap<std::int32_t, std::int32_t> edges) {
  std::vector<std::vector<std::int32_t>> out;
  while (!edges.empty()) {
    std::vector<std::int32_t> path{edges.begin()->first};
    std::map<std::int32_t, size_t> on_path{{path[0], 0}};
    while (!path.empty()) {
      const auto edge = edges.find(path.back());
      if (edge == edges.end()) break;
      const std::int32_t next = edge->second;
      edges.erase(edge);
      const auto seen = on_path.find(next);
      if (seen == on_path.end()) {
        on_path[next] = path.size();
        path.push_back(next);
        continue;
      }
      const auto from = path.begin() + static_cast<std::ptrdiff_t>(seen->second);
      out.emplace_back(from, path.end());
      for (auto v = from + 1; v != path.end(); ++v) on_path.erase(*v);
      path.erase(from + 1, path.end());
      if (path.size() == 1 && edges.find(path[0]) == edges.end()) path.clear();
    }
  }
  return out;
}

}  // namespace

double Outline::area() const {
  double sum = core::signed_area(outer);
  for (const Ring& hole : holes) sum += core::signed_area(hole);
  return sum;
}

bool Outline::holds(const Vector2d& p) const {
  bool in = false;
  const auto cross = [&](const Ring& ring) {
    for (size_t k = 0; k < ring.size(); ++k) in ^= core::crosses_eastward(ring[k], ring[(k + 1) % ring.size()], p.x(), p.y());
  };
  cross(outer);
  for (const Ring& hole : holes) cross(hole);
  return in;
}

bool add_hole(Outline& outline, const Ring& hole) {
  if (hole.size() < 3 || do_meet(hole, outline.outer) || !Outline{outline.outer, {}}.holds(hole[0])) return false;
  for (const Ring& other : outline.holes)
    if (do_meet(hole, other) || Outline{other, {}}.holds(hole[0]) || Outline{hole, {}}.holds(other[0])) return false;
  outline.holes.push_back(hole);
  return true;
}

std::vector<TrianglePart> parts_of(const Tin& tin, std::vector<std::int32_t> label) {
  std::vector<TrianglePart> out;
  for (size_t first = 0; first < tin.size(); ++first) {
    const std::int32_t mine = label[first];
    if (mine < 0) continue;
    TrianglePart part{static_cast<std::int32_t>(first)};
    label[first] = -1;
    for (size_t k = 0; k < part.size(); ++k)
      for (const std::int32_t t : tin.across[static_cast<size_t>(part[k])])
        if (t >= 0 && label[static_cast<size_t>(t)] == mine) label[static_cast<size_t>(t)] = -1, part.push_back(t);
    std::sort(part.begin(), part.end());
    out.push_back(std::move(part));
  }
  return out;
}

std::vector<TrianglePart> parts_of(const Tin& tin) { return parts_of(tin, std::vector<std::int32_t>(tin.size(), 0)); }

Outline rim_of(const Tin& tin, const TrianglePart& part, double least_hole) {
  Outline out;
  double largest = 0.0;
  for (const std::vector<std::int32_t>& vertices : rings_of(rim_edges(tin, part))) {
    Ring ring;
    for (const std::int32_t v : vertices) ring.push_back(place_of(tin, v));
    const double area = core::signed_area(ring);
    if (area > largest)
      largest = area, out.outer = std::move(ring);
    else if (area <= -least_hole)
      out.holes.push_back(std::move(ring));
  }
  std::erase_if(out.holes, [&](const Ring& hole) { return !Outline{out.outer, {}}.holds(0.5 * (hole[0] + hole[1])); });
  return out;
}

bool is_simple(const Ring& r) {
  const size_t n = r.size();
  if (n < 3) return false;
  for (size_t i = 0; i < n; ++i) {
    const Vector2d &a = r[i], &b = r[(i + 1) % n];
    if (a == b) return false;
    for (size_t j = i + 1; j < n; ++j) {
      const Vector2d &c = r[j], &d = r[(j + 1) % n];
      if (j == i + 1 || (i == 0 && j == n - 1)) {  // neighbours: not back along the same line
        const Vector2d &far = j == i + 1 ? d : c, &end = j == i + 1 ? b : a, &start = j == i + 1 ? a : b;
        if (std::abs(side_of(start, end, far)) <= 1e-9 && (far - end).dot(end - start) < 0.0) return false;
        continue;
      }
      if (do_meet(a, b, c, d)) return false;
    }
  }
  return true;
}

double distance_to(const Ring& ring, const Vector2d& p) {
  double least = 1e300;
  for (size_t k = 0; k < ring.size(); ++k) {
    const Vector2d &a = ring[k], side = ring[(k + 1) % ring.size()] - a;
    const double length2 = side.squaredNorm(), t = length2 > 0.0 ? std::clamp((p - a).dot(side) / length2, 0.0, 1.0) : 0.0;
    least = std::min(least, (p - a - t * side).squaredNorm());
  }
  return std::sqrt(least);
}

}  // namespace swath::terrain
