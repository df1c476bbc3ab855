// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/layout.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"

namespace swath::planning {
namespace {

using Eigen::Vector2d;

constexpr double half_angle = 20 * M_PI / 180;

/// `length` along the direction, `width` across, about a middle.
Ring rectangle(double length, double width, double direction, const Vector2d& middle = {5000, 8000}) {
  const Vector2d along(std::sin(direction), std::cos(direction)), across(std::cos(direction), -std::sin(direction));
  Ring r;
  for (const auto& [a, b] : {std::pair(-0.5, -0.5), std::pair(0.5, -0.5), std::pair(0.5, 0.5), std::pair(-0.5, 0.5)})
    r.push_back(middle + a * length * along + b * width * across);
  return r;
}

LayoutTask task(const Ring& area) {
  LayoutTask t;
  t.area = {area};
  t.half_angle = half_angle;
  t.height = 600;
  t.overlap = 0.3;
  return t;
}

/// Nodes every 20 m; heights by a function of the map.
template <class F>
core::HeightField ground_of(const F& height) {
  const int n = 500;
  std::vector<float> z;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) z.push_back(static_cast<float>(height(20.0 * i, 3000 + 20.0 * j)));
  return core::HeightField({0, 3000, 20, 20, n, n}, z);
}

TEST(Layout, LevelGroundNeedsTheFewestLines) {
  const double swath = 2 * 600 * std::tan(half_angle);
  const Layout l = lay_out(task(rectangle(3000, 1500, 0.6)), core::HeightField(100));
  EXPECT_NEAR(l.direction, 0.6, 0.002);  // the longer side
  // n lines hold swath (1 + (n - 1)(1 - overlap)).
  const auto n = static_cast<size_t>(std::ceil(1 + (1500 / swath - 1) / 0.7));
  ASSERT_EQ(l.lines.size(), n);
  EXPECT_NEAR(*l.least_overlap, 1 - (1500 / swath - 1) / static_cast<double>(n - 1), 0.01);  // what is left over is shared
  for (const FlightLine& line : l.lines) {
    EXPECT_NEAR(line.length(), 3000, 15);
    EXPECT_EQ(line.level, 700);
  }
  EXPECT_LT(l.lines[0].along().dot(l.lines[1].along()), -0.999);
}

TEST(Layout, HillsBringTheLinesTogether) {
  const Ring area = rectangle(3000, 2500, 0);
  const auto hills = ground_of([](double x, double y) { return 100 + 120 * std::sin(x / 500) * std::sin(y / 700); });
  const Layout flat = lay_out(task(area), core::HeightField(100)), hilly = lay_out(task(area), hills);
  EXPECT_GT(hilly.lines.size(), flat.lines.size());
  EXPECT_GE(*hilly.least_overlap, 0.3 - 1e-3);
  // By hand, at every place of every pair: the beams that meet the ground farthest out.
  const double tangent = std::tan(half_angle);
  double least = 1.0;
  for (size_t k = 1; k < hilly.lines.size(); ++k) {
    const FlightLine &a = hilly.lines[k - 1], &b = hilly.lines[k];
    for (double y = 6800; y < 9200; y += 10) {
      const auto edge = [&](double x0, double level, double side) {
        double d = 0;
        while (d < (level - hills.height(x0 + side * d, y)) * tangent) d += 0.5;
        return d;
      };
      const double right = edge(a.from.x(), a.level, 1), left = edge(b.from.x(), b.level, -1);
      const double width = 0.5 * (right + left + edge(a.from.x(), a.level, -1) + edge(b.from.x(), b.level, 1));
      least = std::min(least, (right + left - (b.from.x() - a.from.x())) / width);
    }
  }
  EXPECT_GT(least, 0.3 - 0.02);  // stations lie 60 m apart
  EXPECT_NEAR(least, *hilly.least_overlap, 0.02);
}

TEST(Layout, TerrainFollowingGivesEachLineItsHeight) {
  LayoutTask t = task(rectangle(3000, 2500, 0));
  t.terrain_following = true;
  t.level_step = 10;
  t.direction = 0.0;
  const auto slope = ground_of([](double x, double) { return 0.1 * x; });
  const Layout l = lay_out(t, slope);
  for (const FlightLine& line : l.lines) {
    EXPECT_NEAR(line.level - 0.1 * line.from.x(), 600, 45);  // the mean of the strip lies inward at the area's edge
    EXPECT_EQ(std::remainder(line.level, 10), 0);
  }
  EXPECT_GT(l.lines.back().level - l.lines.front().level, 100);
  EXPECT_GE(*l.least_overlap, 0.3 - 1e-3);
}

TEST(Layout, ASpacingMayLeaveAGap) {
  LayoutTask t = task(rectangle(3000, 2500, 0));
  t.spacing = 500;
  const double swath = 2 * 600 * std::tan(half_angle);
  EXPECT_NEAR(*lay_out(t, core::HeightField(0)).least_overlap, 1 - 500 / swath, 1e-3);
}

TEST(Layout, CrossLinesAndMargin) {
  LayoutTask t = task(rectangle(3000, 1500, 0));
  t.cross_lines = 2;
  t.margin = 100;
  const Layout l = lay_out(t, core::HeightField(0));
  size_t cross = 0;
  for (const FlightLine& line : l.lines) {
    EXPECT_NEAR(line.length(), line.cross ? 1700 : 3200, 2);
    if (line.cross) ++cross;
  }
  EXPECT_EQ(cross, 2u);
  EXPECT_NEAR(std::abs(l.lines.back().along().dot(l.lines.front().along())), 0, 1e-9);
}

/// Lines over a triangle end where it does.
TEST(Layout, LinesAreAsLongAsTheAreaIs) {
  LayoutTask t = task({{0, 5000}, {4000, 5000}, {0, 9000}});
  t.direction = 0.0;
  const Layout l = lay_out(t, core::HeightField(0));
  EXPECT_GT(l.lines.front().length(), l.lines.back().length() + 1000);
  for (const FlightLine& line : l.lines) EXPECT_LE(std::max(line.from.y(), line.to.y()), 9000 - line.from.x() + 300);
}

TEST(Layout, ExtentAlongTheLongerSide) {
  const Extent e = extent_of({rectangle(3000, 1500, 0.6)}, std::nullopt);
  EXPECT_NEAR(e.direction, 0.6, 0.002);
  EXPECT_NEAR(e.length, 3000, 10);
  EXPECT_NEAR(e.width, 1500, 10);
  EXPECT_NEAR((e.middle - Vector2d(5000, 8000)).norm(), 0, 5);
  EXPECT_NEAR(extent_of({rectangle(3000, 1500, 0)}, M_PI / 2).length, 1500, 1e-6);
}

TEST(Layout, AnAreaWithAnIsland) {
  const std::vector<Ring> area{rectangle(3000, 3000, 0), rectangle(1000, 1000, 0)};
  EXPECT_FALSE(inside(area, {5000, 8000}));
  EXPECT_TRUE(inside(area, {5000, 8800}));
  EXPECT_FALSE(inside(area, {5000, 9800}));
}

TEST(Layout, GroundThatReachesTheFlightIsRefused) {
  const auto cliff = ground_of([](double x, double) { return x > 5000 ? 2000.0 : 0.0; });
  LayoutTask t = task(rectangle(3000, 2500, 0));
  t.height = 300;
  EXPECT_THROW(lay_out(t, cliff), core::Error);
}

}  // namespace
}  // namespace swath::planning
