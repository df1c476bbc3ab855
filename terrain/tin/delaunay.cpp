// SPDX-License-Identifier: GPL-3.0-or-later
// CGAL inserts; what follows works on the faces as numbers in one array.
#include "terrain/tin/delaunay.h"

#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <utility>

namespace swath::terrain {
namespace {

/// CGAL's exact predicates; notes when a place was found on a circle.
struct LatticeKernel : CGAL::Exact_predicates_inexact_constructions_kernel {
  using Exact = CGAL::Exact_predicates_inexact_constructions_kernel;
  struct Side_of_oriented_circle_2 {
    bool* met;
    CGAL::Oriented_side operator()(const Point_2& a, const Point_2& b, const Point_2& c, const Point_2& d) const {
      const CGAL::Oriented_side side = Exact::Side_of_oriented_circle_2()(a, b, c, d);
      *met |= side == CGAL::ON_ORIENTED_BOUNDARY;
      return side;
    }
  };
  Side_of_oriented_circle_2 side_of_oriented_circle_2_object() const { return {met}; }
  bool* met = nullptr;
};
struct FaceNumber {
  std::int32_t value = -1;
};
using Triangulation = CGAL::Delaunay_triangulation_2<
    LatticeKernel, CGAL::Triangulation_data_structure_2<CGAL::Triangulation_vertex_base_with_info_2<std::int32_t, LatticeKernel>,
                                                        CGAL::Triangulation_face_base_with_info_2<FaceNumber, LatticeKernel>>>;

size_t number_of(Triangulation::Face_handle f) { return static_cast<size_t>(f->info().value); }

Face copy_of(Triangulation::Face_handle f) {
  Face face;
  for (int k = 0; k < 3; ++k) {
    face.v[static_cast<size_t>(k)] = f->vertex(k)->info();
    face.n[static_cast<size_t>(k)] = f->neighbor(k)->info().value;
  }
  return face;
}

}  // namespace

struct Delaunay::Cgal {
  bool met = false;
  Triangulation triangulation;
  Triangulation::Face_handle near;
  std::vector<Triangulation::Vertex_handle> on_circles;  ///< vertices at whose insertion a place was on a circle
  bool copied = false;
  std::vector<Triangulation::Vertex_handle> fresh;  ///< those since the faces were copied

  Cgal() : triangulation(kernel()) {}
  void insert(const Place& p, std::int32_t number) {
    const auto v = triangulation.insert(LatticeKernel::Point_2(p.x, p.y), near);
    v->info() = number;
    near = v->face();
    if (copied) fresh.push_back(v);
    if (std::exchange(met, false)) on_circles.push_back(v);
  }

 private:
  LatticeKernel kernel() {
    LatticeKernel k;
    k.met = &met;
    return k;
  }
};

Delaunay::Delaunay(const std::vector<Place>& places) : places_(places), cgal_(std::make_unique<Cgal>()) {
  cgal_->triangulation.infinite_vertex()->info() = beyond;
}
Delaunay::~Delaunay() = default;

void Delaunay::insert(std::int32_t first, std::int32_t last) {
  for (std::int32_t p = first; p < last; ++p) cgal_->insert(at(p), p);
  copy_faces();
}

void Delaunay::insert(const std::vector<std::int32_t>& order) {
  for (const std::int32_t p : order) cgal_->insert(at(p), p);
  copy_faces();
}

void Delaunay::copy_faces() {
  Triangulation& t = cgal_->triangulation;
  if (t.dimension() < 2) return;
  if (faces_.empty() || settled_) {
    std::int32_t count = 0;
    for (const auto f : t.all_face_handles()) f->info().value = count++;
    faces_.resize(static_cast<size_t>(count));
    for (const auto f : t.all_face_handles()) faces_[number_of(f)] = copy_of(f);
    settled_ = false;
  } else {
    // CGAL takes no face away, and every face that it made or changed has a vertex that is new.
    const auto each = [this](auto&& see) {
      for (const auto v : cgal_->fresh) {
        auto f = v->incident_faces();
        const auto first = f;
        do see(f);
        while (++f != first);
      }
    };
    auto count = static_cast<std::int32_t>(faces_.size());
    each([&](const auto& f) {
      if (f->info().value < 0) f->info().value = count++;
    });
    faces_.resize(static_cast<size_t>(count));
    each([&](const auto& f) {
      faces_[number_of(f)] = copy_of(f);
      for (int k = 0; k < 3; ++k) faces_[number_of(f->neighbor(k))] = copy_of(f->neighbor(k));
    });
  }
  cgal_->fresh.clear();
  cgal_->copied = true;
}

std::int32_t Delaunay::locate(const Place& q, std::int32_t near) const {
  std::int32_t f = near, from = -1;
  if (!faces_[f].is_finite()) f = faces_[f].n[faces_[f].corner_beyond()];
  for (bool moved = true; moved;) {
    moved = false;
    const Face& face = faces_[f];
    for (int k = 0; k < 3 && !moved; ++k) {
      const std::int32_t g = face.n[k];
      if (g == from || orientation(at(face.v[ccw(k)]), at(face.v[cw(k)]), q) >= 0) continue;
      if (!faces_[g].is_finite()) return g;
      from = f;
      f = g;
      moved = true;
    }
  }
  return f;
}

// Of every polygon inscribed in one empty circle the vertex that came last is among on_circles: when it came the others' polygon was there
// (the circle was empty before, too), and CGAL asked on which side of that circle it lies.
std::vector<FacePair> Delaunay::cocircular() const {
  std::vector<FacePair> out;
  if (faces_.empty()) return out;
  std::vector<bool> seen(faces_.size(), false);
  std::vector<std::int32_t> open;
  const auto look_at = [&](std::int32_t f) {
    if (seen[f] || !faces_[f].is_finite()) return;
    seen[f] = true;
    open.push_back(f);
  };
  for (const auto v : cgal_->on_circles) {
    auto around = v->incident_faces();
    const auto first = around;
    do look_at(around->info().value);
    while (++around != first);
    while (!open.empty()) {
      const std::int32_t f = open.back();
      open.pop_back();
      const Face& face = faces_[f];
      for (const std::int32_t g : face.n) {
        if (!faces_[g].is_finite()) continue;
        if (in_circle(at(face.v[0]), at(face.v[1]), at(face.v[2]), at(faces_[g].v[faces_[g].side_of(f)])) != 0) continue;
        if (g > f) out.push_back({f, g});
        look_at(g);
      }
    }
  }
  return out;
}

void Delaunay::settle(const std::vector<FacePair>& pairs) {
  if (pairs.empty()) return;
  settled_ = true;
  cut_as_fans(faces_, places_, pairs);
}

}  // namespace swath::terrain
