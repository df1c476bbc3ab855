// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/target/target_edges.h"

#include <gtest/gtest.h>

#include "calib/target/target_pulses.h"
#include "tests/calib/box_flight.h"

namespace swath::calib {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using namespace test;
constexpr double deg = core::degree;

RoofTarget target_of(const BoxRecords& r) {
  std::vector<Vector3d> corners;
  for (const io::ControlPoint& p : r.control) corners.push_back(p.ecef);
  return roof_target("hall", corners, 1e-4, 1e-4);
}

EdgeOptions options_of(const BoxFlight& f) {
  EdgeOptions o;
  o.range_sigma = f.range_noise;
  o.pointing_sigma = f.angle_noise;
  o.beam_divergence = f.footprint == Footprint::point ? 0.0 : f.divergence;
  o.several_returns = f.several_returns && f.footprint == Footprint::disc;
  o.search = 12.0;
  return o;
}

// What each line makes of the target with the calibration given.
std::vector<TargetView> views_of(const BoxFlight& f, const core::Calibration& calibration) {
  const BoxRecords r = fly(f);
  const RoofTarget target = target_of(r);
  const core::Scanner scanner;
  const ShotGeometry geometry(scanner, calibration);
  const trajectory::Trajectory trajectory(r.delivered);
  const auto shots = r.stream();
  const CollectedPulses pulses = collect_pulses(shots, geometry, trajectory, target, 0.012);
  std::vector<TargetView> out;
  for (const LinePulses& l : pulses.lines) out.push_back(view_target(l.pulses, geometry, trajectory, target, options_of(f)));
  return out;
}

// Sums over lines and seeds of (error / sigma)^2 with nothing to be found.
struct Errors {
  double along = 0.0, across = 0.0, height = 0.0, strain = 0.0, worst = 0.0;
  int n = 0;
};

Errors errors_over_seeds(BoxFlight f, int seeds, const core::Calibration& calibration) {
  Errors e;
  for (int seed = 1; seed <= seeds; ++seed) {
    f.seed = static_cast<std::uint64_t>(seed);
    for (const TargetView& v : views_of(f, calibration)) {
      EXPECT_TRUE(v.seen) << v.why_not;
      if (!v.seen) continue;
      ++e.n;
      e.along += std::pow(v.displacement.x(), 2) / v.covariance(0, 0);
      e.across += std::pow(v.displacement.y(), 2) / v.covariance(1, 1);
      e.height += std::pow(v.height / v.height_sigma, 2);
      e.strain += std::pow(v.strain_across / v.strain_across_sigma, 2);
      e.worst = std::max(e.worst, v.displacement.cwiseAbs().maxCoeff());
    }
  }
  return e;
}

// Error / sigma over some thirty values: within a fifth of one in 95 of 100 cases; a little more is left for their sharing one geometry.
constexpr double lowest_ratio = 0.7, highest_ratio = 1.3;
void expect_true_sigma(const Errors& e) {
  for (const double sum : {e.along, e.across}) {
    EXPECT_GT(std::sqrt(sum / e.n), lowest_ratio);
    EXPECT_LT(std::sqrt(sum / e.n), highest_ratio);
  }
}

TEST(TargetEdges, PointBeams) {
  BoxFlight f;
  f.lines = full_pattern(0.5);
  const Errors e = errors_over_seeds(f, 5, f.truth);
  expect_true_sigma(e);
  EXPECT_LT(e.worst, 0.06);
}

TEST(TargetEdges, EchoesFromAnywhereInTheFootprint) {
  BoxFlight f;
  f.lines = full_pattern(0.5);
  f.footprint = Footprint::jitter;
  f.angle_noise = 2e-5;
  const Errors e = errors_over_seeds(f, 5, f.truth);
  expect_true_sigma(e);
  EXPECT_LT(e.worst, 0.12);
}

TEST(TargetEdges, FirstAndLastReturnsOfAWideFootprint) {
  // 0.35 m: pulses at the edge have a return on the roof and one off it.
  BoxFlight f;
  f.lines = full_pattern(0.5);
  f.footprint = Footprint::disc;
  const Errors e = errors_over_seeds(f, 4, f.truth);
  EXPECT_LT(std::sqrt(e.along / e.n), highest_ratio);
  EXPECT_LT(std::sqrt(e.across / e.n), highest_ratio);
  EXPECT_LT(std::sqrt(e.strain / e.n), highest_ratio);
  EXPECT_LT(e.worst, 0.08);
  for (const TargetView& v : views_of(f, f.truth)) EXPECT_NEAR(v.half_footprint, 0.15, 0.05);  // of 0.175 m, where a twentieth counts
}

TEST(TargetEdges, ASingleReturnMakesTheRoofLarger) {
  BoxFlight f;
  f.lines = full_pattern(0.5);
  f.footprint = Footprint::disc;
  f.several_returns = false;
  const Errors e = errors_over_seeds(f, 4, f.truth);
  EXPECT_LT(std::sqrt(e.along / e.n), highest_ratio);
  EXPECT_LT(std::sqrt(e.across / e.n), highest_ratio);
  EXPECT_LT(std::sqrt(e.strain / e.n), highest_ratio);
  // The growth itself is a sigma off the prior at most, and the widths alone would make the scan's scale wrong by 0.3 / 32.
  for (const TargetView& v : views_of(f, f.truth)) EXPECT_GT(v.growth, 0.05);
}

TEST(TargetEdges, ALargeBoresightIsSeenAsItIs) {
  BoxFlight f;
  f.lines = full_pattern(0.5);
  const core::Calibration wrong = [] {
    core::Calibration c;
    c.roll.value = 0.5 * deg;
    c.pitch.value = -0.5 * deg;
    c.heading.value = 0.5 * deg;
    return c;
  }();
  const auto views = views_of(f, wrong);
  ASSERT_EQ(views.size(), 6u);
  for (size_t i = 0; i < views.size(); ++i) {
    const TargetView& v = views[i];
    ASSERT_TRUE(v.seen) << i << ": " << v.why_not;
    // Nose down by the calibration: 6.1 m backward; roll: 6.1 m to the left; the edge passes backward by the heading as well.
    const double right = f.lines[i].right;
    EXPECT_NEAR(v.displacement.x(), -700.0 * std::tan(0.5 * deg) - right * 0.5 * deg, 0.25) << i;
    EXPECT_NEAR(v.displacement.y(), -700.0 * std::tan(0.5 * deg), 0.75) << i;
    EXPECT_NEAR(v.shear, -0.5 * deg, 0.002) << i;
    EXPECT_NEAR(v.height, -right * 0.5 * deg, 0.5) << i;
  }
}

TEST(TargetEdges, AProfileTellsAlongAlone) {
  BoxFlight f;
  f.azimuth = 0.5;
  f.lines = {{1, 0.5 - 0.06, 0.0, 700.0, true}};  // the body's axis lies along the roof
  f.spacing = 0.4;
  const auto views = views_of(f, f.truth);
  ASSERT_TRUE(views[0].seen) << views[0].why_not;
  EXPECT_LT(std::abs(views[0].displacement.x()), 4.0 * std::sqrt(views[0].covariance(0, 0)));
  EXPECT_LT(std::sqrt(views[0].covariance(0, 0)), 0.5);
  EXPECT_GT(std::sqrt(views[0].covariance(1, 1)), 5.0);
}

TEST(TargetEdges, SaysWhyNot) {
  BoxFlight f;
  f.lines = {{1, 0.5, 0.0, 700.0}, {2, 0.5, 600.0, 700.0}};
  const auto views = views_of(f, f.truth);
  ASSERT_EQ(views.size(), 2u);
  EXPECT_TRUE(views[0].seen);
  EXPECT_TRUE(views[0].all_sides());
  EXPECT_FALSE(views[1].seen);
  EXPECT_NE(views[1].why_not.find("no returns"), std::string::npos) << views[1].why_not;
  // The roof is elsewhere.
  f.roof = 9.0;
  BoxRecords r = fly(f);
  for (io::ControlPoint& p : r.control) p.ecef += 80.0 * r.frame.local_R_ecef.row(0).transpose();
  const core::Scanner scanner;
  const ShotGeometry geometry(scanner, f.truth);
  const trajectory::Trajectory trajectory(r.delivered);
  const RoofTarget moved = target_of(r);
  const auto shots = r.stream();
  const auto pulses = collect_pulses(shots, geometry, trajectory, moved, 0.012);
  const TargetView v = view_target(pulses.lines[0].pulses, geometry, trajectory, moved, options_of(f));
  EXPECT_FALSE(v.seen);
  EXPECT_NE(v.why_not.find("no flat roof"), std::string::npos) << v.why_not;
}

}  // namespace
}  // namespace swath::calib
