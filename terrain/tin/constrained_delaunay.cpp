// SPDX-License-Identifier: GPL-3.0-or-later
// By CGAL (exact predicates, inexact constructions), which leaves free how cocircular points are cut: what has one circle and no constraint
// between is cut by a fixed rule.
#include "terrain/tin/constrained_delaunay.h"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Constrained_triangulation_face_base_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <algorithm>
#include <string>

#include "core/error.h"

namespace swath::terrain {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<std::int32_t, Kernel>;
using FaceBase = CGAL::Triangulation_face_base_with_info_2<std::int32_t, Kernel>;
using Constrained = CGAL::Constrained_Delaunay_triangulation_2<
    Kernel, CGAL::Triangulation_data_structure_2<VertexBase, CGAL::Constrained_triangulation_face_base_2<Kernel, FaceBase>>,
    CGAL::No_constraint_intersection_requiring_constructions_tag>;
using FaceHandle = Constrained::Face_handle;

ConstrainedFaces faces_of(Constrained& dt, const std::vector<Place>& places) {
  ConstrainedFaces out;
  if (dt.dimension() < 2) return out;
  std::int32_t count = 0;
  for (const FaceHandle f : dt.all_face_handles()) f->info() = count++;
  out.faces.resize(static_cast<size_t>(count));
  std::vector<FacePair> cocircular;
  const auto at = [&](FaceHandle f, int k) { return places[static_cast<size_t>(f->vertex(k)->info())]; };
  for (const FaceHandle f : dt.all_face_handles()) {
    Face& face = out.faces[static_cast<size_t>(f->info())];
    for (int k = 0; k < 3; ++k) {
      const FaceHandle g = f->neighbor(k);
      face.v[static_cast<size_t>(k)] = f->vertex(k)->info();
      face.n[static_cast<size_t>(k)] = g->info();
      if (f->info() > g->info()) continue;
      if (f->is_constrained(k))
        out.held.push_back(std::minmax({f->vertex(ccw(k))->info(), f->vertex(cw(k))->info()}));
      else if (!dt.is_infinite(f) && !dt.is_infinite(g) && in_circle(at(f, 0), at(f, 1), at(f, 2), at(g, g->index(f))) == 0)
        cocircular.push_back({f->info(), g->info()});
    }
  }
  cut_as_fans(out.faces, places, cocircular);
  std::sort(out.held.begin(), out.held.end());
  return out;
}

}  // namespace

ConstrainedFaces constrained_delaunay(const std::vector<Place>& places, const std::vector<std::pair<std::int32_t, std::int32_t>>& edges,
                                      const Place& origin) {
  Constrained dt;
  dt.infinite_vertex()->info() = beyond;
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
  return faces_of(dt, places);
}

}  // namespace swath::terrain
