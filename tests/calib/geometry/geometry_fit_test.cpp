// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/geometry/geometry_fit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/calib/gate_flight.h"

namespace swath::calib {
namespace {

using test::GateFlight;

bool held(const std::vector<GeometryCheck>& checks, const std::string& name) {
  const auto at = std::find_if(checks.begin(), checks.end(), [&](const GeometryCheck& c) { return c.name == name; });
  EXPECT_NE(at, checks.end()) << name;
  return at != checks.end() && at->held;
}

double cost_of(const SampledFlight& s, const Chain& chain, const trajectory::Trajectory& t, double predicted) {
  LineCells cells = line_cells(s, chain, t);
  return fit_lines(s, cells, chain, t, predicted).fit.cost;
}

SampledFlight sample_of(const GateFlight& f, const trajectory::Trajectory& t) {
  SampledFlight s;
  s.frame = GateFlight::local();
  s.plan = plan_sample(f.lines, t, s.frame, 0.0, 300.0, {});
  s.sample = collect_samples({&s.plan}, f.input(t).shots).front();
  s.ground = {s.plan.cell, 0.13};
  s.sensor = f.sensor;
  return s;
}

TEST(GeometryFit, AnOffsetOfALineIsReportedAsItIs) {
  constexpr double offset = 0.4;      // m
  constexpr double tolerance = 0.02;  // m: roughness of the ground and its slope
  GateFlight f(true);
  for (size_t i = 0; i < f.data.size(); ++i)
    if (f.data.time[i] > f.lines[1].first - 2 && f.data.time[i] < f.lines[1].last + 2) f.data.height[i] += offset;
  const trajectory::Trajectory t(f.data);
  const SampledFlight s = sample_of(f, t);
  LineCells cells = line_cells(s, f.chain, t);
  const LineFit fit = fit_lines(s, cells, f.chain, t, 0.0);
  double squares = 0;
  for (const LinePair& p : fit.pairs) {
    const double expected = p.line_a == 2 || p.line_b == 2 ? offset : 0.0;
    EXPECT_NEAR(p.rms, expected, tolerance) << p.line_a << " " << p.line_b;
    squares += static_cast<double>(p.cells) * expected * expected;
  }
  ASSERT_EQ(fit.pairs.size(), 3u);
  EXPECT_NEAR(fit.fit.rms, std::sqrt(squares / static_cast<double>(fit.fit.cells)), tolerance);
}

TEST(GeometryFit, ReturnsContradictARolledMountAndWrongHeights) {
  const GateFlight f(true);
  const trajectory::Trajectory t(f.data);
  const SampledFlight s = sample_of(f, t);
  const auto right = check_returns(s, f.chain, t, f.data);
  for (const char* name : {"beams_down", "ground_height", "ground_tilt"}) EXPECT_TRUE(held(right, name)) << name;
  Chain rolled = f.chain;
  rolled.calibration.roll.value += core::pi;
  EXPECT_FALSE(held(check_returns(s, rolled, t, f.data), "beams_down"));
  Chain mirrored = f.chain;
  mirrored.calibration.scan_scale *= -1;
  EXPECT_FALSE(held(check_returns(s, mirrored, t, f.data), "ground_tilt"));
  Chain far = f.chain;
  far.calibration.range_scale *= 5;
  EXPECT_FALSE(held(check_returns(s, far, t, f.data), "ground_height"));
  core::TrajectoryData down = f.data;
  for (double& h : down.height) h = -h;
  const trajectory::Trajectory below(down);
  const auto under = check_returns(sample_of(f, below), f.chain, below, down);
  EXPECT_FALSE(held(under, "ground_height"));
  EXPECT_TRUE(
      std::any_of(under.begin(), under.end(), [](const GeometryCheck& c) { return c.text.find("may count down") != std::string::npos; }));
  EXPECT_LT(cost_of(s, f.chain, t, 0.0), 0.1);
  EXPECT_GT(cost_of(s, mirrored, t, 0.05), 0.4);
}

TEST(GeometryFit, MotionThatNoAircraftMakesIsNotHeld) {
  trajectory::FlightChecks c;
  c.heading = trajectory::HeadingFit{90 * core::degree, 1 * core::degree, 0.02, 50, 5};
  c.roll_turns = trajectory::FactorFit{-1.0, 0.02, 100, -0.95};
  c.climb = trajectory::FactorFit{1.02, 0.01, 100};
  const auto checks = check_motion(c);
  EXPECT_FALSE(held(checks, "heading_bias"));
  EXPECT_TRUE(held(checks, "heading_misfit"));
  EXPECT_FALSE(held(checks, "roll_in_turns"));
  EXPECT_TRUE(held(checks, "climb"));
  EXPECT_TRUE(check_motion({}).empty());
}

TEST(GeometryFit, AStabilisedMountAndACarAreNotBlamed) {
  const auto turns = [](double roll, double roll_correlation, double pitch, double pitch_correlation) {
    trajectory::FlightChecks c;
    c.roll_turns = trajectory::FactorFit{roll, 0.01, 100, roll_correlation};
    c.pitch_turns = trajectory::FactorFit{pitch, 0.01, 100, pitch_correlation};
    return check_motion(c);
  };
  EXPECT_TRUE(held(turns(0.02, 0.1, 0.0, 0.0), "roll_in_turns")) << "stabilised";
  EXPECT_TRUE(held(turns(-0.2, -0.9, 0.0, 0.0), "roll_in_turns")) << "leans outwards";
  EXPECT_TRUE(held(turns(-0.7, -0.5, 0.0, 0.0), "roll_in_turns")) << "gusts";
  EXPECT_FALSE(held(turns(-0.7, -0.9, 0.0, 0.0), "roll_in_turns"));
  EXPECT_TRUE(held(turns(1.0, 0.95, 0.6, 0.9), "pitch_in_turns")) << "pulls up in turns";
  EXPECT_FALSE(held(turns(0.0, 0.1, -0.9, -0.9), "pitch_in_turns")) << "exchanged";
}

}  // namespace
}  // namespace swath::calib
