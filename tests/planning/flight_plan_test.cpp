// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/flight_plan.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "core/config/result_visitors.h"
#include "core/error.h"

namespace swath::planning {
namespace {

using Eigen::Vector2d;

const std::vector<Ring> area{{{1000, 1000}, {4000, 1000}, {4000, 2500}, {1000, 2500}}};

PlanOptions options() {
  PlanOptions o;
  o.sensor.prf = core::Hertz(100e3);
  o.sensor.frequency = core::Hertz(50);
  o.sensor.half_angle = core::degrees(20);
  o.sensor.pulse_energy = core::Joules(2e-6);
  o.flight.height = core::Metres(600);
  o.flight.speed = core::MetresPerSecond(60);
  return o;
}

std::string refusal(const PlanOptions& o, const core::HeightField& ground = core::HeightField(100)) {
  try {
    make_flight_plan(o, area, ground);
  } catch (const core::Error& e) {
    EXPECT_EQ(e.code(), core::Exit::bad_usage);
    EXPECT_FALSE(e.hint().empty()) << e.text();
    return e.what();
  }
  return "";
}

TEST(FlightPlan, FiguresOfAPlainBlock) {
  const FlightPlan p = make_flight_plan(options(), area, core::HeightField(100));
  EXPECT_NEAR(p.area, 4.5e6, 1);
  EXPECT_NEAR(p.swath.width, 2 * 600 * std::tan(20 * M_PI / 180), 1e-6);
  EXPECT_NEAR(p.swath.density, 100e3 / (60 * p.swath.width), 1e-9);
  EXPECT_TRUE(p.warnings.empty()) << p.warnings[0];
  // Every pulse over the area comes down in it; swaths reach beyond it by what is left over.
  EXPECT_GT(p.density.mean, p.swath.density);
  EXPECT_GE(p.seen.least, 0.99);
  EXPECT_EQ(p.unseen_share, 0.0);
  double line = 0.0, turn = 0.0;
  for (const LineFound& l : p.lines) {
    line += l.seconds;
    turn += l.turn_seconds;
    EXPECT_NEAR(l.lowest, 600, 1e-6);
  }
  EXPECT_NEAR(line, p.line_length / 60, 1e-6);
  EXPECT_NEAR(p.seconds, line + turn, 1e-6);
  ASSERT_TRUE(p.eye_safety);
  EXPECT_LT(p.eye_safety->height, 600);
  EXPECT_NEAR(p.photo.height, 0.30, 1e-9);
  ASSERT_EQ(p.budget.size(), 3u);
  EXPECT_NEAR(core::reported(p).find("area_m2")->as_number(), 4.5e6, 1);
}

TEST(FlightPlan, ADensityGivesTheHeight) {
  PlanOptions o = options();
  o.flight.height.reset();
  o.flight.density = 8.0;
  const FlightPlan p = make_flight_plan(o, area, core::HeightField(100));
  EXPECT_NEAR(p.swath.density, 8.0, 1e-6);
  EXPECT_GE(p.density.least, 8.0 * 0.85);  // away from nadir pulses lie farther apart
}

TEST(FlightPlan, ACalibrationFlightMeetsItsTargetInManyWays) {
  PlanOptions o = options();
  o.flight.pattern = PlanPattern::calibration;
  const FlightPlan p = make_flight_plan(o, area, core::HeightField(100));
  EXPECT_EQ(p.lines.size(), 12u);
  EXPECT_EQ(p.lines.back().line.level, 100 + 600 * 11.0 / 7.0);
  const Vector2d middle(2500, 1750);
  for (const LineFound& l : p.lines) {
    const Vector2d d = middle - l.line.from;
    EXPECT_LT(std::abs(l.line.across().dot(d)), (l.line.level - 100) * std::tan(20 * M_PI / 180));
    EXPECT_EQ(l.line.scans, !l.line.name.starts_with("profile"));
  }
  o.sensor.pattern = ScanPattern::polygon;
  EXPECT_EQ(make_flight_plan(o, area, core::HeightField(100)).lines.size(), 10u);
}

/// Cells fit the area where none are asked for.
TEST(FlightPlan, TinyAndHugeAreasHaveCells) {
  const std::vector<Ring> tiny{{{1000, 1000}, {1004, 1000}, {1004, 1003}}}, huge{{{0, 0}, {60e3, 0}, {60e3, 50e3}, {0, 50e3}}};
  const FlightPlan small = make_flight_plan(options(), tiny, core::HeightField(100));
  EXPECT_GT(small.density.median, 3.0);
  PlanOptions o = options();
  o.flight.height = core::Metres(1400);
  o.cost.endurance = core::Seconds(80000);
  const FlightPlan large = make_flight_plan(o, huge, core::HeightField(100));
  EXPECT_GT(large.density.least, 0.5);
  EXPECT_LE(large.coverage.lattice.size(), 4100000u);
}

TEST(FlightPlan, CostsAreSums) {
  PlanOptions o = options();
  o.cost.fixed = 100;
  o.cost.per_line = 10;
  o.cost.per_sortie = 1000;
  o.cost.per_hour = 3600;
  o.cost.transit = core::Seconds(60);
  const FlightPlan one = make_flight_plan(o, area, core::HeightField(100));
  EXPECT_EQ(one.cost.sorties, 1u);
  EXPECT_NEAR(one.cost.total, 100 + 10.0 * static_cast<double>(one.lines.size()) + 1000 + one.seconds + 60, 1e-6);
  o.cost.endurance = core::Seconds(60 + one.seconds / 2);
  const FlightPlan two = make_flight_plan(o, area, core::HeightField(100));
  EXPECT_GE(two.cost.sorties, 2u);
}

TEST(FlightPlan, BasesFarOffAreNamed) {
  PlanOptions o = options();
  o.bases = {{"near", core::Metres(2000), core::Metres(2000)}};
  EXPECT_TRUE(make_flight_plan(o, area, core::HeightField(100)).warnings.empty());
  o.bases = {{"far", core::Metres(2000), core::Metres(60000)}};
  const FlightPlan p = make_flight_plan(o, area, core::HeightField(100));
  ASSERT_EQ(p.warnings.size(), 1u);
  EXPECT_NE(p.warnings[0].find("50 km"), std::string::npos);
}

TEST(FlightPlan, WhatCannotBeFlownIsRefused) {
  PlanOptions o = options();
  o.flight.height.reset();
  o.flight.density = 200;
  EXPECT_NE(refusal(o).find("below the least"), std::string::npos);

  o = options();
  o.flight.spacing = core::Metres(500);
  EXPECT_NE(refusal(o).find("gap"), std::string::npos);

  o = options();
  o.sensor.pulse_energy = core::Joules(10e-3);
  EXPECT_NE(refusal(o).find("eyes on the ground"), std::string::npos);

  o = options();
  o.sensor.prf = core::Hertz(400e3);
  EXPECT_NE(refusal(o).find("in the air"), std::string::npos);
  o.sensor.multiple_pulses = true;
  EXPECT_EQ(refusal(o), "");

  o = options();
  o.cost.endurance = core::Seconds(60);
  o.cost.transit = core::Seconds(50);
  EXPECT_NE(refusal(o).find("longer than a sortie"), std::string::npos);

  // A hill up to the aircraft, and a model that ends within the area.
  std::vector<float> hill(100 * 100, 100.0f), half(100 * 100, 100.0f);
  for (size_t k = 0; k < half.size(); ++k) {
    if (k % 100 == 50) hill[k] = 800.0f;
    if (k % 100 < 50) half[k] = std::nanf("");
  }
  o = options();
  EXPECT_NE(refusal(o, core::HeightField({0, 0, 50, 50, 100, 100}, half)).find("no height on"), std::string::npos);
  EXPECT_NE(refusal(o, core::HeightField({0, 0, 50, 50, 100, 100}, hill)).find("m below the flight"), std::string::npos);

  std::vector<Ring> line{{{0, 0}, {1000, 1000}, {2000, 2000}}};
  EXPECT_THROW(make_flight_plan(o, line, core::HeightField(100)), core::Error);
}

}  // namespace
}  // namespace swath::planning
