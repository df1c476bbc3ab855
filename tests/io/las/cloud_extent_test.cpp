// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/las/cloud_extent.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "tests/io/las_sample.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

using Points = std::vector<Eigen::Vector2d>;

Points field(size_t n, double side, double x0 = 500000.0, double y0 = 5400000.0) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(0.0, side);
  Points out;
  for (size_t i = 0; i < n; ++i) {
    const double x = place(random);
    out.emplace_back(x0 + x, y0 + place(random));
  }
  return out;
}

CloudExtent extent(const Points& points) {
  CloudExtent e(1000.0);
  for (const auto& p : points) e.add(p.x(), p.y());
  e.settle();
  return e;
}

size_t left_out(const Points& points) {
  const CloudExtent e = extent(points);
  return static_cast<size_t>(std::count_if(points.begin(), points.end(), [&](const auto& p) { return !e.holds(p.x(), p.y()); }));
}

TEST(CloudExtent, SinglePointsFarAwayAreNotHeld) {
  for (const double off : {1e5, 1e6, 2e7, 5e8, 1e12, 1e300, std::nan(""), std::numeric_limits<double>::infinity()}) {
    Points points = field(5000, 200.0);
    points[10] = {500000.0 + off, 5400000.0 - off};
    const CloudExtent e = extent(points);
    EXPECT_FALSE(e.holds(points[10].x(), points[10].y())) << off;
    EXPECT_EQ(left_out(points), 1u) << off;
    EXPECT_EQ(e.points(), 4999u);
    EXPECT_LT(e.high().x(), 500200.0);
    EXPECT_GT(e.low().y(), 5400000.0);
  }
}

TEST(CloudExtent, ManyScatteredAndManyAtOnePlaceAreNotHeld) {
  Points points = field(5000, 200.0);
  for (const auto& p : field(300, 1e6, 0.0, 5e6)) points.push_back(p);
  EXPECT_GE(left_out(points), 290u);
  points = field(5000, 200.0);
  points.insert(points.end(), 500, Eigen::Vector2d(0.0, 0.0));
  EXPECT_EQ(left_out(points), 500u);
}

TEST(CloudExtent, RareButRightPointsAreHeld) {
  EXPECT_EQ(left_out(field(6280, 5000.0)), 0u);
  EXPECT_EQ(left_out(field(30, 25000.0)), 0u);
  EXPECT_EQ(left_out(field(1000, 400000.0)), 0u);
  EXPECT_EQ(left_out(field(3, 1e6)), 0u);  // too few to say
  Points corridor;
  for (int i = 0; i < 20000; ++i) corridor.emplace_back(5.0 * i, 0.02 * (i % 100));
  EXPECT_EQ(left_out(corridor), 0u);
  Points village = field(20000, 1000.0);  // and a few points in the hills around
  for (const auto& p : field(20, 50000.0, 475000.0, 5375000.0)) village.push_back(p);
  EXPECT_EQ(left_out(village), 0u);
}

TEST(CloudExtent, IslandsOfManyPointsAreHeldHoweverFar) {
  Points islands = field(20000, 500.0);
  for (const auto& p : field(150, 300.0, 900000.0, 5000000.0)) islands.push_back(p);
  EXPECT_EQ(left_out(islands), 0u);
}

TEST(CloudExtent, WhereManyLieFarNoneIsKnownToBeWrong) {
  // More than a quarter: numbers over the whole range of the file's integers, or a maker's own coordinates.
  Points points = field(2000, 1000.0);
  for (const auto& p : field(1000, 1e8, 0.0, 0.0)) points.push_back(p);
  EXPECT_EQ(left_out(points), 0u);
}

TEST(CloudExtent, HeightsBeyondThoseAskedForAreFewOrNot) {
  const test::TemporaryFolder folder;
  const LasHeader h = test::sample_header(6);
  LasPoints p = test::sample_points(h, 2000);  // three of them at heights of the whole range of the file's integers
  test::write_sample(folder / "a.las", h, p);
  EXPECT_TRUE(extent_of_cloud(folder / "a.las", 1000.0, -12e3, 20e3, 1).has_few_wild_heights);
  for (size_t i = 0; i < p.size(); ++i) p.raw_z[i] = 1900000000;  // geocentric: 4,750 km
  test::write_sample(folder / "b.las", h, p);
  EXPECT_FALSE(extent_of_cloud(folder / "b.las", 1000.0, -12e3, 20e3, 1).has_few_wild_heights);
}

TEST(CloudExtent, TheOrderOfPointsChangesNothing) {
  Points points = field(20000, 3000.0);
  for (const auto& p : field(300, 1e6, 0.0, 5e6)) points.push_back(p);
  const CloudExtent first = extent(points);
  std::shuffle(points.begin(), points.end(), std::mt19937(3));
  const CloudExtent second = extent(points);
  EXPECT_EQ(first.low(), second.low());
  EXPECT_EQ(first.high(), second.high());
  for (const auto& p : points) EXPECT_EQ(first.holds(p.x(), p.y()), second.holds(p.x(), p.y()));
}

TEST(CloudExtent, OfNoPointsHoldsNone) {
  const CloudExtent e = extent({});
  EXPECT_EQ(e.points(), 0u);
  EXPECT_FALSE(std::isfinite(e.low().x()));
}

TEST(CloudExtent, AFilesBoxIsTakenOnlyWhereItCanBeRight) {
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder / "a.las";
  const LasHeader h = test::sample_header(6);
  const LasPoints p = test::sample_points(h, 2000);
  test::write_sample(file, h, p);
  const CloudExtent right = extent_of_cloud(file, 1000.0, -1e7, 1e7, 1).places;
  EXPECT_TRUE(right.is_stated());
  EXPECT_EQ(right.points(), 2000u);
  EXPECT_TRUE(right.holds(p.x[0], p.y[0]));
  EXPECT_FALSE(right.holds(p.x[0] + 1e5, p.y[0]));
  const std::string bytes = test::read_bytes(file);
  for (const auto& [high_x, low_x] : {std::pair{1e8, 0.0}, {1.0, 0.0}, {0.0, 1.0}, {p.x[0], p.x[0]}, {std::nan(""), 0.0}, {2e9, 1.9e9}}) {
    std::string wrong = bytes;
    const double box[] = {high_x, low_x};
    wrong.replace(179, sizeof box, reinterpret_cast<const char*>(box), sizeof box);
    test::write_bytes(file, wrong);
    const CloudExtent looked_at = extent_of_cloud(file, 1000.0, -1e7, 1e7, 1).places;
    EXPECT_FALSE(looked_at.is_stated()) << high_x;
    EXPECT_EQ(looked_at.points(), 2000u) << high_x;
    EXPECT_LT((looked_at.low() - right.low()).norm() + (looked_at.high() - right.high()).norm(), 1e-6) << high_x;
  }
}

}  // namespace
}  // namespace swath::io
