// SPDX-License-Identifier: GPL-3.0-or-later
// CGAL inserts; what follows works on the faces as numbers in one array.
#include "terrain/delaunay.h"

#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <algorithm>
#include <numeric>
#include <utility>

namespace swath::terrain {
namespace {

/// CGAL's exact predicates; notes when a place was found on a circle.
struct Kernel : CGAL::Exact_predicates_inexact_constructions_kernel {
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
using Triangulation =
    CGAL::Delaunay_triangulation_2<Kernel,
                                   CGAL::Triangulation_data_structure_2<CGAL::Triangulation_vertex_base_with_info_2<std::int32_t, Kernel>,
                                                                        CGAL::Triangulation_face_base_with_info_2<FaceNumber, Kernel>>>;

int next(int k) { return k == 2 ? 0 : k + 1; }
int last(int k) { return k == 0 ? 2 : k - 1; }

int index_of(const std::array<std::int32_t, 3>& of, std::int32_t what) { return of[0] == what ? 0 : of[1] == what ? 1 : 2; }

size_t number_of(Triangulation::Face_handle f) { return static_cast<size_t>(f->info().value); }

Delaunay::Face copy_of(Triangulation::Face_handle f) {
  Delaunay::Face face;
  for (int k = 0; k < 3; ++k) {
    face.v[static_cast<size_t>(k)] = f->vertex(k)->info();
    face.n[static_cast<size_t>(k)] = f->neighbor(k)->info().value;
  }
  return face;
}

std::int32_t root_of(std::vector<std::int32_t>& parent, std::int32_t f) {
  while (parent[f] != f) f = parent[f] = parent[parent[f]];
  return f;
}

/// Cuts the convex polygon of `members` anew as a fan from its first vertex.
void fan(std::vector<Delaunay::Face>& faces, const std::vector<Place>& places, const std::vector<std::int32_t>& members,
         const std::vector<std::int32_t>& polygon) {
  struct Side {
    std::int32_t from, to, across, back;
  };
  std::vector<Side> sides;
  for (const std::int32_t m : members)
    for (int k = 0; k < 3; ++k) {
      const std::int32_t g = faces[m].n[k];
      if (polygon[g] == polygon[m]) continue;
      sides.push_back({faces[m].v[next(k)], faces[m].v[last(k)], g, index_of(faces[g].n, m)});
    }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) { return a.from < b.from; });
  std::vector<Side> ring{*std::min_element(sides.begin(), sides.end(), [&](const Side& a, const Side& b) {
    return is_before(places[static_cast<size_t>(a.from)], places[static_cast<size_t>(b.from)]);
  })};
  while (ring.size() < sides.size())
    ring.push_back(*std::lower_bound(sides.begin(), sides.end(), ring.back().to, [](const Side& s, std::int32_t v) { return s.from < v; }));
  const auto link = [&](std::int32_t f, int k, const Side& s) {
    faces[f].n[k] = s.across;
    faces[s.across].n[s.back] = f;
  };
  for (size_t i = 0; i < members.size(); ++i) {
    const std::int32_t f = members[i];
    faces[f].v = {ring[0].from, ring[i + 1].from, ring[i + 1].to};
    link(f, 0, ring[i + 1]);
    if (i == 0)
      link(f, 2, ring[0]);
    else
      faces[f].n[2] = members[i - 1];
    if (i + 1 == members.size())
      link(f, 1, ring.back());
    else
      faces[f].n[1] = members[i + 1];
  }
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
    const auto v = triangulation.insert(Kernel::Point_2(p.x, p.y), near);
    v->info() = number;
    near = v->face();
    if (copied) fresh.push_back(v);
    if (std::exchange(met, false)) on_circles.push_back(v);
  }

 private:
  Kernel kernel() {
    Kernel k;
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
  if (!faces_[f].is_finite()) f = faces_[f].n[index_of(faces_[f].v, beyond)];
  for (bool moved = true; moved;) {
    moved = false;
    const Face& face = faces_[f];
    for (int k = 0; k < 3 && !moved; ++k) {
      const std::int32_t g = face.n[k];
      if (g == from || orientation(at(face.v[next(k)]), at(face.v[last(k)]), q) >= 0) continue;
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
std::vector<Delaunay::Pair> Delaunay::cocircular() const {
  std::vector<Pair> out;
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
        if (in_circle(at(face.v[0]), at(face.v[1]), at(face.v[2]), at(faces_[g].v[index_of(faces_[g].n, f)])) != 0) continue;
        if (g > f) out.push_back({f, g});
        look_at(g);
      }
    }
  }
  return out;
}

void Delaunay::settle(const std::vector<Pair>& pairs) {
  if (pairs.empty()) return;
  settled_ = true;
  std::vector<std::int32_t> polygon(faces_.size());
  std::iota(polygon.begin(), polygon.end(), 0);
  for (const auto& [f, g] : pairs) polygon[root_of(polygon, g)] = root_of(polygon, f);
  std::vector<Pair> member;  // polygon, face
  for (const auto& pair : pairs)
    for (const std::int32_t f : pair) member.push_back({root_of(polygon, f), f});
  for (const auto& [root, f] : member) polygon[f] = root;
  std::sort(member.begin(), member.end());
  member.erase(std::unique(member.begin(), member.end()), member.end());
  std::vector<std::int32_t> members;
  for (size_t i = 0; i < member.size();) {
    members.clear();
    const std::int32_t root = member[i].front();
    for (; i < member.size() && member[i].front() == root; ++i) members.push_back(member[i].back());
    fan(faces_, places_, members, polygon);
  }
}

}  // namespace swath::terrain
