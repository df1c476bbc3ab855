// SPDX-License-Identifier: GPL-3.0-or-later
// By CGAL (exact predicates, inexact constructions), which leaves free how cocircular points are cut; here the unique subdivision (polygons
// inscribed in the empty circles, joined across edges that are no constraints) is recovered and cut by a fixed rule.
#include "terrain/constrained_delaunay.h"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Constrained_triangulation_face_base_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <algorithm>
#include <numeric>
#include <string>

#include "core/error.h"
#include "terrain/delaunay.h"

namespace swath::terrain {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<std::int32_t, Kernel>;
using FaceBase = CGAL::Triangulation_face_base_with_info_2<std::int32_t, Kernel>;
using Constrained = CGAL::Constrained_Delaunay_triangulation_2<
    Kernel, CGAL::Triangulation_data_structure_2<VertexBase, CGAL::Constrained_triangulation_face_base_2<Kernel, FaceBase>>,
    CGAL::No_constraint_intersection_requiring_constructions_tag>;
using FaceHandle = Constrained::Face_handle;

std::int32_t root_of(std::vector<std::int32_t>& parent, std::int32_t f) {
  while (parent[f] != f) f = parent[f] = parent[parent[f]];
  return f;
}

// Joins the faces that have one circumcircle; returns the root of each face's polygon.
std::vector<std::int32_t> polygons_of(const Constrained& dt, const std::vector<FaceHandle>& faces) {
  std::vector<std::int32_t> parent(faces.size());
  std::iota(parent.begin(), parent.end(), 0);
  for (const FaceHandle f : faces) {
    for (int k = 0; k < 3; ++k) {
      const FaceHandle g = f->neighbor(k);
      if (dt.is_infinite(g) || g->info() < f->info() || f->is_constrained(k)) continue;
      const auto across = g->vertex(g->index(f))->point();
      const auto side = CGAL::side_of_oriented_circle(f->vertex(0)->point(), f->vertex(1)->point(), f->vertex(2)->point(), across);
      if (side == CGAL::ON_ORIENTED_BOUNDARY) parent[root_of(parent, g->info())] = root_of(parent, f->info());
    }
  }
  for (std::int32_t f = 0; f < static_cast<std::int32_t>(faces.size()); ++f) parent[f] = root_of(parent, f);
  return parent;
}

// The polygon made of `members`, as a fan from its first vertex.
template <class Emit>
void fan(const Constrained& dt, const std::vector<Place>& places, const std::vector<FaceHandle>& members,
         const std::vector<std::int32_t>& polygon, Emit&& emit) {
  std::vector<std::pair<std::int32_t, std::int32_t>> border;  // directed edges, counter-clockwise
  for (const FaceHandle f : members)
    for (int k = 0; k < 3; ++k) {
      const FaceHandle g = f->neighbor(k);
      if (!dt.is_infinite(g) && polygon[g->info()] == polygon[f->info()]) continue;
      border.emplace_back(f->vertex(Constrained::ccw(k))->info(), f->vertex(Constrained::cw(k))->info());
    }
  std::sort(border.begin(), border.end());
  const auto next = [&](std::int32_t v) {
    return std::lower_bound(border.begin(), border.end(), std::make_pair(v, std::int32_t{-1}))->second;
  };
  const auto place = [&](std::int32_t v) { return places[static_cast<size_t>(v)]; };
  const std::int32_t apex = std::min_element(border.begin(), border.end(), [&](const auto& a, const auto& b) {
                              return is_before(place(a.first), place(b.first));
                            })->first;
  for (std::int32_t v = next(apex), w = next(v); w != apex; v = w, w = next(w)) emit({apex, v, w});
}

ConstrainedTriangles triangles_of(Constrained& dt, const std::vector<Place>& places) {
  ConstrainedTriangles out;
  if (dt.dimension() < 2) return out;
  std::vector<FaceHandle> faces;
  faces.reserve(dt.number_of_faces());
  for (const FaceHandle f : dt.finite_face_handles()) {
    f->info() = static_cast<std::int32_t>(faces.size());
    faces.push_back(f);
  }
  const std::vector<std::int32_t> polygon = polygons_of(dt, faces);
  out.triangles.reserve(faces.size());
  const auto emit = [&](std::array<std::int32_t, 3> t) { out.triangles.push_back(t); };
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
    std::vector<FaceHandle> members;
    const std::int32_t p = shared[i].first;
    for (; i < shared.size() && shared[i].first == p; ++i) members.push_back(faces[shared[i].second]);
    fan(dt, places, members, polygon, emit);
  }
  for (const auto f : faces)
    for (int k = 0; k < 3; ++k) {
      if (!f->is_constrained(k) || (!dt.is_infinite(f->neighbor(k)) && f->neighbor(k)->info() < f->info())) continue;
      out.held.push_back(std::minmax({f->vertex(Constrained::ccw(k))->info(), f->vertex(Constrained::cw(k))->info()}));
    }
  std::sort(out.held.begin(), out.held.end());
  return out;
}

}  // namespace

ConstrainedTriangles constrained_delaunay(const std::vector<Place>& places, const std::vector<std::pair<std::int32_t, std::int32_t>>& edges,
                                          const Place& origin) {
  Constrained dt;
  std::vector<Constrained::Vertex_handle> handles;
  handles.reserve(places.size());
  FaceHandle near;
  for (const Place& p : places) {
    handles.push_back(dt.insert(Kernel::Point_2(p.x, p.y), near));
    handles.back()->info() = static_cast<std::int32_t>(handles.size()) - 1;
    near = handles.back()->face();
  }
  for (const auto& [a, b] : edges) {
    if (a == b) continue;
    try {
      dt.insert_constraint(handles[static_cast<size_t>(a)], handles[static_cast<size_t>(b)]);
    } catch (const Constrained::Intersection_of_constraints_exception&) {
      const Place& at = places[static_cast<size_t>(a)];
      throw core::Error("constraints cross between their vertices",
                        "x " + std::to_string(origin.x + at.x) + ", y " + std::to_string(origin.y + at.y));
    }
  }
  return triangles_of(dt, places);
}

}  // namespace swath::terrain
