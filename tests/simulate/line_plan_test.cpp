// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulate/line_plan.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "core/error.h"

namespace swath::simulate {
namespace {

constexpr double half_angle = 27 * core::degree;

FlightOptions calibration() {
  FlightOptions f;
  f.pattern = FlightPattern::calibration;
  f.height = core::Metres(700);
  f.cross_lines = 2;
  return f;
}
WorldOptions airfield() {
  WorldOptions w;
  w.scene = Scene::airfield;
  w.length = w.width = core::Metres(720);
  return w;
}
std::vector<LinePlan> plan_of(const FlightOptions& f) { return plan_lines(f, airfield(), half_angle, 0.01); }

std::vector<std::string> names(const std::vector<LinePlan>& plan) {
  std::vector<std::string> out;
  for (const LinePlan& l : plan) out.push_back(l.name);
  return out;
}

Eigen::Vector2d way(const LinePlan& l) { return (l.to - l.from).normalized(); }

/// Easting and northing become the plane's true north and east by PROJ; the level counts from the flight's height.
TEST(LinePlan, GivenLinesLieWhereTheMapHasThem) {
  const core::Crs crs("EPSG:32632");
  const core::Geodetic origin{47.9 * core::degree, 10.5 * core::degree, 600};
  const LocalPlane plane(origin, 1200);
  const auto lines = given_lines(
      {{"", {core::Metres(612000), core::Metres(5306000)}, {core::Metres(613000), core::Metres(5307000)}, core::Metres(1250), true},
       {"back", {core::Metres(613000), core::Metres(5307000)}, {core::Metres(612000), core::Metres(5306000)}, core::Metres(1150), false}},
      crs, plane, 1200);
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_EQ(lines[0].name, "line 1");
  EXPECT_EQ(lines[1].name, "back");
  EXPECT_EQ(lines[0].level, 50);
  EXPECT_FALSE(lines[1].scans);
  const core::Transform to_map(core::wgs84_geodetic(), crs);
  const core::Geodetic g = plane.geodetic_of({lines[0].to.x(), lines[0].to.y(), 1250});
  const Eigen::Vector3d map = to_map({core::to_degrees(g.longitude), core::to_degrees(g.latitude), 1250});
  EXPECT_NEAR(map.x(), 613000, 1e-3);
  EXPECT_NEAR(map.y(), 5307000, 1e-3);
  EXPECT_THROW(
      given_lines(
          {{"", {core::Metres(612000), core::Metres(5306000)}, {core::Metres(612000), core::Metres(5306000)}, core::Metres(1200), true}},
          crs, plane, 1200),
      core::Error);
}

TEST(LinePlan, LinesOverlapAsAsked) {
  FlightOptions o;
  o.height = core::Metres(500);
  o.overlap = 0.25;
  o.lines = 4;
  o.cross_lines = 2;
  const auto plan = plan_lines(o, {}, 0.3, 0.0);
  ASSERT_EQ(plan.size(), 6u);
  const double swath = 2 * 500 * std::tan(0.3);
  const Eigen::Vector2d a = 0.5 * (plan[0].from + plan[0].to), b = 0.5 * (plan[1].from + plan[1].to);
  EXPECT_NEAR((a - b).norm(), 0.75 * swath, 1e-9);
  EXPECT_NEAR((plan[0].to - plan[0].from).normalized().dot((plan[4].to - plan[4].from).normalized()), 0.0, 1e-12);
  EXPECT_NEAR((plan[0].to - plan[0].from).normalized().dot((plan[1].to - plan[1].from).normalized()), -1.0, 1e-12);
}

constexpr std::array<std::pair<size_t, size_t>, 6> pairs{{{0, 2}, {1, 3}, {4, 5}, {6, 7}, {8, 10}, {9, 11}}};

TEST(LinePlan, ACalibrationFlightHasItsPartsInTheirOrder) {
  const std::vector<LinePlan> plan = plan_of(calibration());
  const std::vector<std::string> expected{"along 1",   "across 1",  "along 2",      "across 2",      "edge right 1", "edge right 2",
                                          "profile 1", "profile 2", "high along 1", "high across 1", "high along 2", "high across 2"};
  EXPECT_EQ(names(plan), expected);
  for (const LinePlan& l : plan) {
    EXPECT_EQ(l.level, l.name.starts_with("high") ? 400.0 : 0.0) << l.name;
    EXPECT_EQ(l.scans, !l.name.starts_with("profile")) << l.name;
    EXPECT_NEAR((l.to - l.from).norm(), 720 + 0.7 * 700, 1e-9) << l.name;
    const bool across = l.name.find("across") != std::string::npos;
    EXPECT_NEAR(std::abs(way(l).dot(way(plan[0]))), across ? 0.0 : 1.0, 1e-12) << l.name;
    if (!l.name.starts_with("edge")) {
      EXPECT_LT((l.from + l.to).norm(), 1e-9) << l.name;
    }
  }
  for (const auto& [one, other] : pairs) EXPECT_NEAR(way(plan[one]).dot(way(plan[other])), -1.0, 1e-12) << plan[one].name;
}

TEST(LinePlan, EdgeLinesHaveTheBuildingWithinTheirSwathsRightEdge) {
  for (const double height : {300.0, 700.0, 2000.0}) {
    FlightOptions f = calibration();
    f.height = core::Metres(height);
    const std::vector<LinePlan> plan = plan_of(f);
    const double half_swath = height * std::tan(half_angle), half_width = airfield_building(airfield()).half_width;
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    for (size_t i : {4u, 5u}) {
      const Eigen::Vector2d middle = 0.5 * (plan[i].from + plan[i].to), right(-way(plan[i]).y(), way(plan[i]).x());
      const double to_the_right = -right.dot(middle);
      EXPECT_GT(to_the_right, 0.5 * half_swath - 1e-9) << height;
      // Below 150 m the building is too wide for the edge.
      EXPECT_LT(to_the_right + half_width, half_swath) << height;
      sum += middle;
    }
    EXPECT_LT(sum.norm(), 1e-9);  // one on each side
  }
}

TEST(LinePlan, PartsOfACalibrationFlightCanBeLeftOut) {
  FlightOptions f = calibration();
  f.cross_lines = 0;
  f.profile_lines = false;
  EXPECT_EQ(names(plan_of(f)),
            (std::vector<std::string>{"along 1", "along 2", "edge right 1", "edge right 2", "high along 1", "high along 2"}));
  f.edge_lines = false;
  f.second_height = core::Metres(0);
  EXPECT_EQ(names(plan_of(f)), (std::vector<std::string>{"along 1", "along 2"}));
  f.lines = 1;
  EXPECT_EQ(names(plan_of(f)), (std::vector<std::string>{"along 1"}));
  f = calibration();
  f.opposite = false;
  const std::vector<LinePlan> plan = plan_of(f);
  EXPECT_EQ(plan[4].name, "edge right 1");
  EXPECT_EQ(plan[5].name, "edge left 2");
  for (const auto& [one, other] : pairs) EXPECT_NEAR(way(plan[one]).dot(way(plan[other])), 1.0, 1e-12);
  f.second_height = core::Metres(1000);
  EXPECT_EQ(plan_of(f).back().level, 300.0);
}

}  // namespace
}  // namespace swath::simulate
