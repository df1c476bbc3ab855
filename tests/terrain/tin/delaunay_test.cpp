// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/tin/delaunay.h"

#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>
#include <set>

namespace swath::terrain {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Reference =
    CGAL::Delaunay_triangulation_2<Kernel, CGAL::Triangulation_data_structure_2<CGAL::Triangulation_vertex_base_with_info_2<int, Kernel>>>;
using Triangles = std::set<std::array<std::int32_t, 3>>;

Triangles triangles(const Delaunay& dt) {
  Triangles out;
  for (const auto& f : dt.faces()) {
    auto v = f.v;
    std::sort(v.begin(), v.end());
    if (!f.is_finite()) continue;
    EXPECT_TRUE(out.insert(v).second);
  }
  return out;
}

Triangles reference(const std::vector<Place>& places) {
  Reference dt;
  for (size_t i = 0; i < places.size(); ++i) dt.insert(Kernel::Point_2(places[i].x, places[i].y))->info() = static_cast<int>(i);
  Triangles out;
  for (const auto f : dt.finite_face_handles()) {
    std::array<std::int32_t, 3> v{f->vertex(0)->info(), f->vertex(1)->info(), f->vertex(2)->info()};
    std::sort(v.begin(), v.end());
    out.insert(v);
  }
  return out;
}

/// Links that lead back, faces that turn left, circles that are empty of the vertices across.
void expect_sound(const Delaunay& dt, const std::vector<Place>& places) {
  const auto& faces = dt.faces();
  const auto at = [&](std::int32_t v) { return places[static_cast<size_t>(v)]; };
  for (std::int32_t f = 0; f < static_cast<std::int32_t>(faces.size()); ++f) {
    const auto& face = faces[static_cast<size_t>(f)];
    if (face.is_finite()) {
      ASSERT_EQ(orientation(at(face.v[0]), at(face.v[1]), at(face.v[2])), 1);
    }
    for (size_t k = 0; k < 3; ++k) {
      const auto& other = faces[static_cast<size_t>(face.n[k])];
      const size_t back = static_cast<size_t>(std::find(other.n.begin(), other.n.end(), f) - other.n.begin());
      ASSERT_LT(back, 3u);
      ASSERT_EQ(face.v[(k + 1) % 3], other.v[(back + 2) % 3]);
      ASSERT_EQ(face.v[(k + 2) % 3], other.v[(back + 1) % 3]);
      if (face.is_finite() && other.is_finite()) {
        ASSERT_LE(in_circle(at(face.v[0]), at(face.v[1]), at(face.v[2]), at(other.v[back])), 0);
      }
    }
  }
}

std::vector<Place> random_places(size_t n, double step, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> part(0.0, 100.0);
  std::set<std::pair<double, double>> distinct;
  while (distinct.size() < n) {
    const auto one = [&] { return step > 0.0 ? std::round(part(random) / step) * step : part(random); };
    const double x = one();
    distinct.insert({x, one()});
  }
  std::vector<Place> out;
  for (const auto& [x, y] : distinct) out.push_back({x, y});
  std::shuffle(out.begin(), out.end(), random);
  return out;
}

TEST(Delaunay, AgreesWithCgal) {
  for (const size_t n : {3u, 4u, 5u, 10u, 100u, 5000u})
    for (unsigned seed = 0; seed < 5; ++seed) {
      const std::vector<Place> places = random_places(n, 0.0, seed);
      Delaunay dt(places);
      dt.insert(0, static_cast<std::int32_t>(n));
      EXPECT_EQ(triangles(dt), reference(places));
      expect_sound(dt, places);
    }
}

TEST(Delaunay, GrowsInPieces) {
  for (const double step : {0.0, 4.0}) {
    const std::vector<Place> places = random_places(600, step, 7);
    Delaunay whole(places), grown(places);
    whole.insert(0, 600);
    std::int32_t first = 0;
    for (const std::int32_t next : {5, 6, 200, 201, 250, 600}) {
      grown.insert(first, next);
      first = next;
      expect_sound(grown, {places.begin(), places.begin() + next});
    }
    for (Delaunay* dt : {&whole, &grown}) dt->settle(dt->cocircular());
    EXPECT_EQ(triangles(grown), triangles(whole));
  }
}

TEST(Delaunay, CocircularAndCollinearPlaces) {
  // On whole numbers nearly every square is cocircular and every row and column of the hull collinear.
  for (unsigned seed = 0; seed < 20; ++seed) {
    const std::vector<Place> places = random_places(600, 4.0, seed);
    std::vector<std::int32_t> order(places.size());
    std::iota(order.begin(), order.end(), 0);
    Delaunay dt(places);
    dt.insert(order);
    expect_sound(dt, places);
    const size_t before = triangles(dt).size();
    EXPECT_EQ(before, reference(places).size());
    dt.settle(dt.cocircular());
    expect_sound(dt, places);
    EXPECT_EQ(triangles(dt).size(), before);
    std::mt19937 random(seed);
    for (int again = 0; again < 3; ++again) {
      std::shuffle(order.begin(), order.end(), random);
      Delaunay other(places);
      other.insert(order);
      other.settle(other.cocircular());
      EXPECT_EQ(triangles(other), triangles(dt));
    }
  }
}

TEST(Delaunay, PlacesOnOneLineWait) {
  std::vector<Place> places;
  for (int i = 0; i < 20; ++i) places.push_back({static_cast<double>((i * 7) % 20), 2.0 * ((i * 7) % 20)});
  Delaunay dt(places);
  dt.insert(0, 20);
  EXPECT_TRUE(dt.faces().empty());
  places.push_back({5.0, 0.0});
  dt.insert(20, 21);
  EXPECT_EQ(triangles(dt).size(), 19u);
  expect_sound(dt, places);
}

}  // namespace
}  // namespace swath::terrain
