// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/noise/column_tree.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <random>

namespace swath::filters {
namespace {

/// The k least squared distances, ascending, and how many were offered.
struct Least {
  explicit Least(size_t k) : value(k, std::numeric_limits<double>::infinity()) {}
  void offer(double v) {
    ++offered;
    if (!(v < value.back())) return;
    value.back() = v;
    std::sort(value.begin(), value.end());
  }
  double worst() const { return value.back(); }
  std::vector<double> value;
  size_t offered = 0;
};

Least of_all(const std::vector<Bins::Point>& points, const Bins::Point& p, size_t k) {
  Least out(k);
  for (const Bins::Point& q : points) {
    const double dx = q.x - p.x, dy = q.y - p.y, dz = q.z - p.z;
    out.offer(dx * dx + dy * dy + dz * dz);
  }
  return out;
}

std::vector<Bins::Point> made(size_t n, const std::function<Bins::Point(std::mt19937&)>& point) {
  std::mt19937 random(3);
  std::vector<Bins::Point> out;
  for (size_t k = 0; k < n; ++k) out.push_back(point(random));
  return out;
}

double uniform(std::mt19937& random, double width) { return std::uniform_real_distribution<double>(0.0, width)(random); }
double step(std::mt19937& random) { return 0.01 * static_cast<double>(random() % 4); }

TEST(ColumnTree, FindsToTheLastBitWhatAllPointsWould) {
  using Random = std::mt19937&;
  const auto even = [](Random r) { return Bins::Point{uniform(r, 0.3), uniform(r, 0.3), uniform(r, 0.3)}; };
  const auto wall = [](Random r) { return Bins::Point{0.1, uniform(r, 0.3), uniform(r, 60.0)}; };
  const auto few_places = [](Random r) { return Bins::Point{step(r), step(r), step(r)}; };
  const auto one_place = [](Random r) {
    return r() % 10 ? Bins::Point{0.1, 0.2, 0.3} : Bins::Point{uniform(r, 0.3), 0.2, uniform(r, 9.0)};
  };
  const std::vector<std::vector<Bins::Point>> clouds{made(5, even), made(3000, even), made(3000, wall), made(3000, few_places),
                                                     made(3000, one_place)};
  for (const std::vector<Bins::Point>& points : clouds) {
    const ColumnTree tree(points);
    for (size_t n = 0; n < points.size(); n += 7)
      for (const Bins::Point& p :
           {points[n], Bins::Point{points[n].x + 0.4, points[n].y - 0.1, points[n].z + 0.01 * static_cast<double>(n % 5)}})
        for (const size_t k : {size_t{1}, size_t{5}, size_t{41}}) {
          Least least(k);
          tree.offer(p, least);
          ASSERT_EQ(least.value, of_all(points, p, k).value);
        }
  }
}

TEST(ColumnTree, PointsAtOnePlaceAreNotGoneThrough) {
  const std::vector<Bins::Point> points(10000, {1.0, 2.0, 3.0});
  const ColumnTree tree(points);
  for (const Bins::Point& p : {points[0], Bins::Point{1.5, 2.5, 3.5}}) {
    Least least(5);
    tree.offer(p, least);
    EXPECT_EQ(least.value, of_all(points, p, 5).value);
    EXPECT_EQ(least.offered, 5u);
  }
}

TEST(ColumnTree, NothingInItOffersNothing) {
  Least least(1);
  ColumnTree({}).offer({0.0, 0.0, 0.0}, least);
  EXPECT_EQ(least.offered, 0u);
}

}  // namespace
}  // namespace swath::filters
