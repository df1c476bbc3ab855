// SPDX-License-Identifier: GPL-3.0-or-later
// Delaunay triangulation by CGAL (exact predicates, inexact constructions). CGAL leaves free how cocircular points are cut; here the
// unique Delaunay subdivision (polygons inscribed in the empty circles) is recovered first and cut by a fixed rule.
//
// Locality. Let D(t) be the closed disc of a polygon t of the subdivision, r its radius, q a place in t, and let S be a subset of all
// points P with S = P within distance 2R of q. q is in t, t in D(t), so D(t) lies within 2r of q. A polygon with r <= R is in the
// subdivision of a set exactly if the interior of D(t) holds no point of the set and t is the hull of the set's points on the circle.
// All points that this speaks of lie within 2R of q, where S = P. So t covers q in the subdivision of S exactly if it does in that of P.
// The fan is a function of the polygon alone; hence the same holds for its triangles.
//
// Constraints. A triangle t is in the constrained Delaunay subdivision exactly if no constraint crosses its interior and the interior of
// D(t) holds no vertex that is visible from a place in t (Lee & Lin 1986, "Generalized Delaunay triangulation for planar graphs"). The line
// of sight to such a vertex lies within D(t), so only vertices in D(t) and constraints that come into D(t) have a say: the argument above
// holds word for word, whatever stands for constraints farther away. Cocircular faces are joined across edges that are no constraints.
//
// Rounding: the radius is compared after rounding (relative error below 1e-9 for edges over 1 mm in triangles under 1 km), always from
// the same three vertices in the same order; callers keep a margin of that size in their halo.
#include "terrain/tin.h"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Constrained_triangulation_face_base_2.h>
#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>
#include <utility>

#include "core/error.h"

namespace swath::terrain {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<std::int32_t, Kernel>;
using FaceBase = CGAL::Triangulation_face_base_with_info_2<std::int32_t, Kernel>;
using Delaunay = CGAL::Delaunay_triangulation_2<Kernel, CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>>;
using Constrained = CGAL::Constrained_Delaunay_triangulation_2<
    Kernel, CGAL::Triangulation_data_structure_2<VertexBase, CGAL::Constrained_triangulation_face_base_2<Kernel, FaceBase>>,
    CGAL::No_constraint_intersection_requiring_constructions_tag>;
using Triangle = std::array<std::int32_t, 3>;

struct Candidate {
  double x, y, z;
  float sigma_v, sigma_h;
  bool of_ground = true;
};

// NaN last, so that a point of known sigma stands before one of unknown sigma.
float rank(float sigma) { return std::isnan(sigma) ? std::numeric_limits<float>::infinity() : sigma; }

bool before(const Candidate& a, const Candidate& b) {
  if (a.x != b.x) return a.x < b.x;
  return std::make_tuple(a.y, a.of_ground, a.z, rank(a.sigma_v), rank(a.sigma_h)) <
         std::make_tuple(b.y, b.of_ground, b.z, rank(b.sigma_v), rank(b.sigma_h));
}

void take_vertices(const core::Block& b, const std::vector<std::uint32_t>& rows, const Constraints& lines, Tin& tin) {
  std::vector<Candidate> candidates;
  candidates.reserve(rows.size() + lines.x.size());
  for (size_t k = 0; k < lines.x.size(); ++k) candidates.push_back({lines.x[k], lines.y[k], lines.z[k], lines.sigma_v[k], 0.0f, false});
  for (const std::uint32_t i : rows) {
    if (!std::isfinite(b.x[i]) || !std::isfinite(b.y[i]) || !std::isfinite(b.z[i])) {
      ++tin.not_finite;
      continue;
    }
    candidates.push_back({b.x[i], b.y[i], b.z[i], b.sigma_v.empty() ? 0.0f : b.sigma_v[i], b.sigma_h.empty() ? 0.0f : b.sigma_h[i]});
  }
  std::sort(candidates.begin(), candidates.end(), before);
  const auto end =
      std::unique(candidates.begin(), candidates.end(), [](const Candidate& p, const Candidate& q) { return p.x == q.x && p.y == q.y; });
  tin.duplicates = static_cast<size_t>(candidates.end() - end);
  candidates.erase(end, candidates.end());

  for (auto* column : {&tin.x, &tin.y, &tin.z}) column->reserve(candidates.size());
  if (!b.sigma_v.empty()) tin.sigma_v.reserve(candidates.size());
  if (!b.sigma_h.empty()) tin.sigma_h.reserve(candidates.size());
  for (const Candidate& c : candidates) {
    tin.x.push_back(c.x);
    tin.y.push_back(c.y);
    tin.z.push_back(c.z);
    if (!b.sigma_v.empty()) tin.sigma_v.push_back(c.sigma_v);
    if (!b.sigma_h.empty()) tin.sigma_h.push_back(c.sigma_h);
  }
}

// Place of (x, y), each below 2^16, on a Hilbert curve (Hilbert 1891).
std::uint32_t hilbert_index(std::uint32_t x, std::uint32_t y) {
  constexpr std::uint32_t side = 1u << 16;
  std::uint32_t index = 0;
  for (std::uint32_t s = side / 2; s > 0; s /= 2) {
    const std::uint32_t rx = (x & s) ? 1 : 0, ry = (y & s) ? 1 : 0;
    index += s * s * ((3 * rx) ^ ry);
    if (ry) continue;
    if (rx) x = side - 1 - x, y = side - 1 - y;
    std::swap(x, y);
  }
  return index;
}

// Index of the vertex at (x, y), which is there.
std::int32_t vertex_at(const Tin& tin, double x, double y) {
  auto low = std::lower_bound(tin.x.begin(), tin.x.end(), x) - tin.x.begin();
  while (tin.y[static_cast<size_t>(low)] != y) ++low;
  return static_cast<std::int32_t>(low);
}

// The vertices in an order in which each is near the one before, so that CGAL finds its triangle in a few steps. The triangulation that
// is handed out does not depend on it.
std::vector<std::int32_t> insertion_order(const Tin& tin) {
  const auto [south, north] = std::minmax_element(tin.y.begin(), tin.y.end());
  const double west = tin.x.front(), low = *south;
  const double span = std::max({tin.x.back() - west, *north - low, std::numeric_limits<double>::min()});
  const auto cell = [span](double v) { return static_cast<std::uint32_t>(std::min(v / span * 65536.0, 65535.0)); };
  std::vector<std::uint64_t> keys(tin.x.size());
  for (size_t i = 0; i < keys.size(); ++i)
    keys[i] = static_cast<std::uint64_t>(hilbert_index(cell(tin.x[i] - west), cell(tin.y[i] - low))) << 32 | i;
  std::sort(keys.begin(), keys.end());
  std::vector<std::int32_t> order(keys.size());
  std::transform(keys.begin(), keys.end(), order.begin(), [](std::uint64_t k) { return static_cast<std::int32_t>(k & 0xffffffffu); });
  return order;
}

std::int32_t root_of(std::vector<std::int32_t>& parent, std::int32_t f) {
  while (parent[f] != f) f = parent[f] = parent[parent[f]];
  return f;
}

bool is_constraint(const Delaunay::Face_handle&, int) { return false; }
bool is_constraint(const Constrained::Face_handle& f, int k) { return f->is_constrained(k); }

// Joins the faces that have one circumcircle; returns the root of each face's polygon.
template <class T>
std::vector<std::int32_t> polygons_of(const T& dt, const std::vector<typename T::Face_handle>& faces) {
  std::vector<std::int32_t> parent(faces.size());
  std::iota(parent.begin(), parent.end(), 0);
  for (const typename T::Face_handle f : faces) {
    for (int k = 0; k < 3; ++k) {
      const typename T::Face_handle g = f->neighbor(k);
      if (dt.is_infinite(g) || g->info() < f->info() || is_constraint(f, k)) continue;
      const auto across = g->vertex(g->index(f))->point();
      const auto side = CGAL::side_of_oriented_circle(f->vertex(0)->point(), f->vertex(1)->point(), f->vertex(2)->point(), across);
      if (side == CGAL::ON_ORIENTED_BOUNDARY) parent[root_of(parent, g->info())] = root_of(parent, f->info());
    }
  }
  for (std::int32_t f = 0; f < static_cast<std::int32_t>(faces.size()); ++f) parent[f] = root_of(parent, f);
  return parent;
}

// The polygon made of `members`, as a fan from its smallest vertex.
template <class T, class Emit>
void fan(const T& dt, const std::vector<typename T::Face_handle>& members, const std::vector<std::int32_t>& polygon, Emit&& emit) {
  std::vector<std::pair<std::int32_t, std::int32_t>> border;  // directed edges, counter-clockwise
  for (const typename T::Face_handle f : members)
    for (int k = 0; k < 3; ++k) {
      const typename T::Face_handle g = f->neighbor(k);
      if (!dt.is_infinite(g) && polygon[g->info()] == polygon[f->info()]) continue;
      border.emplace_back(f->vertex(T::ccw(k))->info(), f->vertex(T::cw(k))->info());
    }
  std::sort(border.begin(), border.end());
  const auto next = [&](std::int32_t v) {
    return std::lower_bound(border.begin(), border.end(), std::make_pair(v, std::int32_t{-1}))->second;
  };
  const std::int32_t apex = border.front().first;
  for (std::int32_t v = next(apex), w = next(v); w != apex; v = w, w = next(w)) emit(Triangle{apex, v, w});
}

// The triangles of a triangulation whose vertices' infos are the indices of tin's.
template <class T>
void take_triangles(T& dt, double max_radius, Tin& tin) {
  if (dt.dimension() < 2) return;
  std::vector<typename T::Face_handle> faces;
  faces.reserve(dt.number_of_faces());
  for (const typename T::Face_handle f : dt.finite_face_handles()) {
    f->info() = static_cast<std::int32_t>(faces.size());
    faces.push_back(f);
  }
  const std::vector<std::int32_t> polygon = polygons_of(dt, faces);

  tin.triangles.reserve(faces.size());
  const auto emit = [&](Triangle t) {
    std::sort(t.begin(), t.end());
    tin.triangles.push_back(t);
    const double radius = circumcircle(tin, static_cast<std::int32_t>(tin.triangles.size()) - 1).radius;
    if (!(radius <= max_radius)) tin.triangles.pop_back();
  };
  std::vector<std::int32_t> members_of(faces.size(), 0);
  for (const std::int32_t p : polygon) ++members_of[p];
  std::vector<std::pair<std::int32_t, std::int32_t>> shared;  // (polygon, face) of the polygons of several faces
  for (std::int32_t f = 0; f < static_cast<std::int32_t>(faces.size()); ++f) {
    const auto& face = faces[f];
    if (members_of[polygon[f]] == 1)
      emit({face->vertex(0)->info(), face->vertex(1)->info(), face->vertex(2)->info()});
    else
      shared.emplace_back(polygon[f], f);
  }
  std::sort(shared.begin(), shared.end());
  for (size_t i = 0; i < shared.size();) {
    std::vector<typename T::Face_handle> members;
    const std::int32_t p = shared[i].first;
    for (; i < shared.size() && shared[i].first == p; ++i) members.push_back(faces[shared[i].second]);
    fan(dt, members, polygon, emit);
  }
  for (const auto f : faces)
    for (int k = 0; k < 3; ++k) {
      if (!is_constraint(f, k) || (!dt.is_infinite(f->neighbor(k)) && f->neighbor(k)->info() < f->info())) continue;
      tin.constrained.push_back(std::minmax({f->vertex(T::ccw(k))->info(), f->vertex(T::cw(k))->info()}));
    }
  std::sort(tin.constrained.begin(), tin.constrained.end());
}

// Inserts tin's vertices; returns their handles by index.
template <class T>
std::vector<typename T::Vertex_handle> insert_vertices(T& dt, const Tin& tin) {
  std::vector<typename T::Vertex_handle> handles(tin.x.size());
  typename T::Face_handle near;
  for (const std::int32_t i : insertion_order(tin)) {
    const typename T::Vertex_handle v = dt.insert(Kernel::Point_2(tin.x[i], tin.y[i]), near);
    v->info() = i;
    handles[i] = v;
    near = v->face();
  }
  return handles;
}

}  // namespace

Circumcircle circumcircle(const Tin& tin, std::int32_t triangle) {
  const auto [a, b, c] = tin.triangles[static_cast<size_t>(triangle)];
  const double bx = tin.x[b] - tin.x[a], by = tin.y[b] - tin.y[a];
  const double cx = tin.x[c] - tin.x[a], cy = tin.y[c] - tin.y[a];
  const double twice_area = bx * cy - by * cx;
  const double bb = bx * bx + by * by, cc = cx * cx + cy * cy;
  const double ux = (cy * bb - by * cc) / (2.0 * twice_area), uy = (bx * cc - cx * bb) / (2.0 * twice_area);
  const double aa = (bx - cx) * (bx - cx) + (by - cy) * (by - cy);
  return {tin.x[a] + ux, tin.y[a] + uy, std::sqrt(aa) * std::sqrt(bb) * std::sqrt(cc) / (2.0 * std::abs(twice_area))};
}

Tin triangulate(const core::Block& block, const std::vector<std::uint32_t>& rows, double max_radius) {
  return triangulate(block, rows, {}, max_radius);
}

Tin triangulate(const core::Block& block, const std::vector<std::uint32_t>& rows, const Constraints& constraints, double max_radius) {
  Tin tin;
  take_vertices(block, rows, constraints, tin);
  if (tin.x.empty()) return tin;
  if (constraints.empty()) {
    Delaunay dt;
    insert_vertices(dt, tin);
    take_triangles(dt, max_radius, tin);
    return tin;
  }
  Constrained dt;
  const std::vector<Constrained::Vertex_handle> handles = insert_vertices(dt, tin);
  const auto handle = [&](std::int32_t k) {
    return handles[static_cast<size_t>(vertex_at(tin, constraints.x[static_cast<size_t>(k)], constraints.y[static_cast<size_t>(k)]))];
  };
  for (const auto& [a, b] : constraints.edges) {
    if (handle(a) == handle(b)) continue;
    try {
      dt.insert_constraint(handle(a), handle(b));
    } catch (const Constrained::Intersection_of_constraints_exception&) {
      throw core::Error("constraints cross between their vertices",
                        "x " + std::to_string(block.origin.x() + constraints.x[static_cast<size_t>(a)]) + ", y " +
                            std::to_string(block.origin.y() + constraints.y[static_cast<size_t>(a)]));
    }
  }
  take_triangles(dt, max_radius, tin);
  return tin;
}

std::vector<std::array<std::int32_t, 3>> neighbours(const Tin& tin) {
  struct HalfEdge {
    std::int32_t high, triangle, opposite;
  };
  // Half edges in buckets of their lower vertex: both sides of an edge meet in one short bucket.
  std::vector<size_t> start(tin.x.size() + 1, 0);
  const auto lower = [](const Triangle& t, int opposite) { return opposite == 0 ? t[1] : t[0]; };
  const auto higher = [](const Triangle& t, int opposite) { return opposite == 2 ? t[1] : t[2]; };
  for (const Triangle& t : tin.triangles)
    for (int k = 0; k < 3; ++k) ++start[lower(t, k) + 1];
  std::partial_sum(start.begin(), start.end(), start.begin());
  std::vector<HalfEdge> edges(3 * tin.triangles.size());
  std::vector<size_t> fill(start.begin(), start.end() - 1);
  for (size_t t = 0; t < tin.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) edges[fill[lower(tin.triangles[t], k)]++] = {higher(tin.triangles[t], k), static_cast<std::int32_t>(t), k};

  std::vector<Triangle> out(tin.triangles.size(), Triangle{-1, -1, -1});
  for (size_t v = 0; v + 1 < start.size(); ++v) {
    const auto first = edges.begin() + static_cast<std::ptrdiff_t>(start[v]),
               last = edges.begin() + static_cast<std::ptrdiff_t>(start[v + 1]);
    std::sort(first, last, [](const HalfEdge& a, const HalfEdge& b) { return a.high < b.high; });
    for (auto e = first; e != last && e + 1 != last; ++e) {
      const auto& other = *(e + 1);
      if (e->high != other.high) continue;
      out[e->triangle][e->opposite] = other.triangle;
      out[other.triangle][other.opposite] = e->triangle;
    }
  }
  return out;
}

}  // namespace swath::terrain
