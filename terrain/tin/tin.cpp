// SPDX-License-Identifier: GPL-3.0-or-later
// Locality. Let D(t) be the closed disc of a polygon t of the Delaunay subdivision, r its radius, q a place in t, and let S be a subset of
// all points P with S = P within distance 2R of q. q is in t, t in D(t), so D(t) lies within 2r of q. A polygon with r <= R is in the
// subdivision of a set exactly if the interior of D(t) holds no point of the set and t is the hull of the set's points on the circle.
// All points that this speaks of lie within 2R of q, where S = P. So t covers q in the subdivision of S exactly if it does in that of P.
// The fan is a function of the polygon alone; hence the same holds for its triangles.
//
// Constraints. A triangle t is in the constrained Delaunay subdivision exactly if no constraint crosses its interior and the interior of
// D(t) holds no vertex that is visible from a place in t (Lee & Lin 1986, "Generalized Delaunay triangulation for planar graphs"). The line
// of sight to such a vertex lies within D(t), so only vertices in D(t) and constraints that come into D(t) have a say: the argument above
// holds word for word, whatever stands for constraints farther away. Cocircular faces are joined across edges that are no constraints.
//
// A part. Points near the rectangle are inserted first (S). A face that touches the rectangle and whose disc holds no point of P that is
// not in S is a face of P's triangulation; the half plane beyond an edge of the hull is the disc of what lies out there. So as long as such
// a disc reaches a cell of points that were not inserted, they are: but only cells within 2R of the part of the rectangle that the face
// covers. Let the face f of S and the face t of P, with a radius of R at most, cover a place q in that part. t's vertices lie within 2R of
// q, so none of them that is not in S lies in D(f), nor does one that is; and D(t) is empty. Two faces that each have an empty disc
// overlap only where their circles are the same, and a vertex on D(f)'s circle would have been inserted. Where f has a radius of R at most
// and is no face of P, D(f) holds a point of P within 2R of q, which would have been inserted.
//
// Rounding: the radius is compared after rounding (relative error below 1e-9 for edges over 1 mm in triangles under 1 km), always from
// the same three vertices in the same order; callers keep a margin of that size in their halo.
#include "terrain/tin/tin.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "terrain/tin/constrained_delaunay.h"
#include "terrain/tin/delaunay.h"
#include "terrain/tin/hilbert_order.h"
#include "terrain/tin/surroundings.h"

namespace swath::terrain {
namespace {

using Triangle = std::array<std::int32_t, 3>;

/// Takes points and vertices of constraints as vertices of a Tin. Sources: rows of the Block, behind them the vertices of the constraints.
class Vertices {
 public:
  Vertices(const core::Block& block, const Constraints& lines, Tin& tin)
      : b_(block), lines_(lines), tin_(tin), points_(static_cast<std::uint32_t>(block.size())), of_line_(lines.x.size(), -1) {}

  /// Appends what stands at the places of `sources`, near ones behind one another. Places of two calls must differ.
  void take(const std::vector<std::uint32_t>& sources) {
    std::vector<Place> at(sources.size());
    for (size_t i = 0; i < sources.size(); ++i) at[i] = place(sources[i]);
    std::vector<OnCurve> order = along_hilbert_curve(at);
    for (auto* column : {&tin_.x, &tin_.y, &tin_.z}) column->reserve(column->size() + order.size());
    places_.reserve(places_.size() + order.size());
    tin_.row.reserve(places_.capacity());
    if (!b_.sigma_v.empty()) tin_.sigma_v.reserve(places_.capacity());
    if (!b_.sigma_h.empty()) tin_.sigma_h.reserve(places_.capacity());
    for (size_t i = 0, end = 0; i < order.size(); i = end) {
      while (end < order.size() && order[end].cell == order[i].cell) ++end;
      if (end - i > 1)
        std::sort(order.begin() + static_cast<std::ptrdiff_t>(i), order.begin() + static_cast<std::ptrdiff_t>(end),
                  [&](const OnCurve& p, const OnCurve& q) { return rank(sources[p.number]) < rank(sources[q.number]); });
      for (size_t k = i; k < end; ++k) put(sources[order[k].number], at[order[k].number], k == i);
    }
  }

  const std::vector<Place>& places() const { return places_; }
  std::int32_t count() const { return static_cast<std::int32_t>(places_.size()); }
  /// Vertex at a vertex of the constraints.
  std::int32_t of_line(std::int32_t k) const { return of_line_[static_cast<size_t>(k)]; }

 private:
  Place place(std::uint32_t s) const { return s < points_ ? Place{b_.x[s], b_.y[s]} : Place{lines_.x[s - points_], lines_.y[s - points_]}; }
  double height(std::uint32_t s) const { return s < points_ ? b_.z[s] : lines_.z[s - points_]; }
  float sigma_v(std::uint32_t s) const { return s >= points_ ? lines_.sigma_v[s - points_] : b_.sigma_v.empty() ? 0.0f : b_.sigma_v[s]; }
  float sigma_h(std::uint32_t s) const { return s >= points_ || b_.sigma_h.empty() ? 0.0f : b_.sigma_h[s]; }
  // Of one place constraints come first, then the lowest; NaN last, so that a point of known sigma stands before one of unknown sigma.
  std::tuple<double, double, bool, double, float, float, std::uint32_t> rank(std::uint32_t s) const {
    const Place p = place(s);
    const auto known = [](float sigma) { return std::isnan(sigma) ? std::numeric_limits<float>::infinity() : sigma; };
    return {p.x, p.y, s < points_, height(s), known(sigma_v(s)), known(sigma_h(s)), s};
  }
  void put(std::uint32_t s, const Place& p, bool first) {
    const bool again = !first && places_.back().x == p.x && places_.back().y == p.y;
    if (again) {
      tin_.duplicates.push_back(p);
    } else {
      places_.push_back(p);
      tin_.x.push_back(p.x);
      tin_.y.push_back(p.y);
      tin_.z.push_back(height(s));
      tin_.row.push_back(s);
      if (!b_.sigma_v.empty()) tin_.sigma_v.push_back(sigma_v(s));
      if (!b_.sigma_h.empty()) tin_.sigma_h.push_back(sigma_h(s));
    }
    if (s >= points_) of_line_[s - points_] = count() - 1;
  }

  const core::Block& b_;
  const Constraints& lines_;
  Tin& tin_;
  std::uint32_t points_;
  std::vector<Place> places_;
  std::vector<std::int32_t> of_line_;
};

/// The rows whose coordinates are finite.
std::vector<std::uint32_t> finite(const core::Block& b, const std::vector<std::uint32_t>& rows, Tin& tin) {
  std::vector<std::uint32_t> out;
  out.reserve(rows.size());
  for (const std::uint32_t r : rows)
    if (std::isfinite(b.x[r]) && std::isfinite(b.y[r]) && std::isfinite(b.z[r])) out.push_back(r);
  tin.not_finite = rows.size() - out.size();
  return out;
}

/// Gives tin.triangles and tin.across the faces that come near `where` and whose circles are small enough.
class Selection {
 public:
  Selection(const std::vector<Face>& faces, const std::vector<Place>& places, double max_radius, const Rectangle& where, Tin& tin)
      : faces_(faces), places_(places), max_radius_(max_radius), where_(where), tin_(tin) {}

  void take() {
    const auto size = static_cast<std::int32_t>(faces_.size());
    std::vector<std::int8_t> order(faces_.size(), -1);
    std::vector<std::int32_t> number(faces_.size(), -1);
    std::int32_t count = 0;
    for (std::int32_t f = 0; f < size; ++f) {
      if (faces_[f].is_finite()) order[f] = order_of(faces_[f]);
      if (order[f] >= 0) number[f] = count++;
    }
    tin_.triangles.reserve(static_cast<size_t>(count));
    tin_.across.reserve(static_cast<size_t>(count));
    for (std::int32_t f = 0; f < size; ++f) {
      if (order[f] < 0) continue;
      const auto [i, j, k] = orders[static_cast<size_t>(order[f])];
      const auto& [v, n] = faces_[f];
      tin_.triangles.push_back({v[i], v[j], v[k]});
      tin_.across.push_back({number[n[i]], number[n[j]], number[n[k]]});
    }
  }

 private:
  /// By three answers as bits: is vertex 1 before 0, 2 before 0, 2 before 1?
  static constexpr std::array<std::array<std::uint8_t, 3>, 8> orders{
      {{0, 1, 2}, {1, 0, 2}, {}, {1, 2, 0}, {0, 2, 1}, {}, {2, 0, 1}, {2, 1, 0}}};

  /// The one of `orders` in which the vertices ascend; -1 where the face is left out.
  std::int8_t order_of(const Face& face) const {
    const std::array<Place, 3> p{places_[face.v[0]], places_[face.v[1]], places_[face.v[2]]};
    if (std::max(std::max(p[0].y, p[1].y), p[2].y) < where_.south || std::min(std::min(p[0].y, p[1].y), p[2].y) > where_.north) return -1;
    const int order = is_before(p[1], p[0]) | is_before(p[2], p[0]) << 1 | is_before(p[2], p[1]) << 2;
    const auto [i, j, k] = orders[static_cast<size_t>(order)];
    if (p[k].x < where_.west || p[i].x > where_.east || TriangleMeasures(p[i], p[j], p[k]).wider_than(max_radius_)) return -1;
    return static_cast<std::int8_t>(order);
  }

  const std::vector<Face>& faces_;
  const std::vector<Place>& places_;
  double max_radius_;
  const Rectangle& where_;
  Tin& tin_;
};

}  // namespace

bool Tin::is_before(std::int32_t a, std::int32_t b) const {
  const Triangle &s = triangles[static_cast<size_t>(a)], &t = triangles[static_cast<size_t>(b)];
  for (size_t k = 0; k < 3; ++k)
    if (s[k] != t[k]) return terrain::is_before(place(s[k]), place(t[k]));
  return false;
}

Circumcircle circumcircle(const Tin& tin, std::int32_t triangle) {
  const auto [a, b, c] = tin.triangles[static_cast<size_t>(triangle)];
  return circumcircle(tin.place(a), tin.place(b), tin.place(c));
}

Tin triangulate(const core::Block& block, const std::vector<std::uint32_t>& rows, double max_radius, const Rectangle& where) {
  Tin tin;
  const Constraints none;
  Vertices vertices(block, none, tin);
  Delaunay dt(vertices.places());
  const std::vector<std::uint32_t> usable = finite(block, rows, tin);
  Surroundings around(block, usable, where, max_radius);
  for (std::vector<std::uint32_t> more = around.first(); !more.empty(); more = around.needed(dt, vertices.places())) {
    const std::int32_t first = vertices.count();
    vertices.take(more);
    dt.insert(from_coarse_to_fine(first, vertices.count()));
  }
  dt.settle(dt.cocircular());
  Selection(dt.faces(), vertices.places(), max_radius, where, tin).take();
  return tin;
}

Tin triangulate(const core::Block& block, const std::vector<std::uint32_t>& rows, const Constraints& constraints, double max_radius,
                const Rectangle& where) {
  if (constraints.empty()) return triangulate(block, rows, max_radius, where);
  Tin tin;
  Vertices vertices(block, constraints, tin);
  std::vector<std::uint32_t> sources = finite(block, rows, tin);
  for (size_t k = 0; k < constraints.x.size(); ++k) sources.push_back(static_cast<std::uint32_t>(block.size() + k));
  vertices.take(sources);
  std::vector<std::pair<std::int32_t, std::int32_t>> edges;
  for (const auto& [a, b] : constraints.edges) edges.emplace_back(vertices.of_line(a), vertices.of_line(b));
  ConstrainedFaces found = constrained_delaunay(vertices.places(), edges, {block.origin.x(), block.origin.y()});
  Selection(found.faces, vertices.places(), max_radius, where, tin).take();
  tin.constrained = std::move(found.held);
  return tin;
}

}  // namespace swath::terrain
