// SPDX-License-Identifier: GPL-3.0-or-later
#include "trajectory/compare.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/config/result_visitors.h"
#include "core/geo/frames.h"
#include "core/geo/geodesy.h"

namespace swath::trajectory {
namespace {

using Eigen::Vector3d;

constexpr double start = 1.4e9, arc_second = core::degree / 3600.0;

/// A flight north-west whose heading sways through north; 100 s.
core::TrajectoryData flight(double rate, double delay = 0.0) {
  core::TrajectoryData d;
  for (int i = 0; i <= static_cast<int>((100.0 - 2.0 * delay) * rate); ++i) {
    const double t = start + delay + i / rate, s = t - start;
    d.time.push_back(t);
    d.latitude.push_back(0.8 + 50.0 / 6.37e6 * s);
    d.longitude.push_back(0.2 - 30.0 / 6.37e6 * s);
    d.height.push_back(1000.0 + 5.0 * std::sin(0.1 * s));
    d.roll.push_back(0.02 * std::sin(0.5 * s));
    d.pitch.push_back(0.03 * std::cos(0.3 * s));
    d.heading.push_back(core::wrap_two_pi(0.05 * std::sin(0.2 * s)));
  }
  return d;
}

/// The flight moved by a shift north, east, down (m) and turned by roll, pitch, heading (rad).
core::TrajectoryData disturbed(core::TrajectoryData d, const Vector3d& shift, const Vector3d& turn) {
  for (size_t i = 0; i < d.size(); ++i) {
    const Vector3d p =
        core::ecef_of({d.latitude[i], d.longitude[i], d.height[i]}) + core::ecef_R_ned(d.latitude[i], d.longitude[i]) * shift;
    const core::Geodetic g = core::geodetic_of(p);
    d.latitude[i] = g.latitude;
    d.longitude[i] = g.longitude;
    d.height[i] = g.height;
    d.roll[i] += turn[0];
    d.pitch[i] += turn[1];
    d.heading[i] = core::wrap_two_pi(d.heading[i] + turn[2]);
  }
  return d;
}

void state(core::TrajectoryData& d, const Vector3d& position, const Vector3d& attitude) {
  const auto fill = [&](std::vector<float>& column, double v) { column.assign(d.size(), static_cast<float>(v)); };
  fill(d.sigma_north, position[0]);
  fill(d.sigma_east, position[1]);
  fill(d.sigma_down, position[2]);
  fill(d.sigma_roll, attitude[0]);
  fill(d.sigma_pitch, attitude[1]);
  fill(d.sigma_heading, attitude[2]);
}

// GPS times are rounded to 0.24 us: 14 um along track at 58 m/s; rates below 0.02 rad/s move angles by less than 1e-8 rad.
constexpr double position_tolerance = 2e-5, angle_tolerance = 1e-8;

TEST(Compare, AKnownErrorIsFoundInItsComponentAtAnyRate) {
  const Trajectory truth(flight(100.0));
  const Vector3d shift(0.02, -0.03, 0.05), turn(10 * arc_second, -20 * arc_second, 90 * arc_second);
  core::TrajectoryData d = disturbed(flight(37.0, 0.013), shift, turn);
  state(d, {0.01, 0.03, 0.1}, Vector3d(10, 10, 30) * arc_second);
  const core::TrajectoryErrors errors = errors_against(d, truth);
  ASSERT_EQ(errors.size(), d.size());
  EXPECT_EQ(errors.outside, 0u);
  const Comparison c = compare(errors);
  EXPECT_EQ(c.compared, d.size());
  const double over[] = {2.0, 1.0, 0.5, 1.0, 2.0, 3.0};
  for (size_t k = 0; k < 6; ++k) {
    const double want = k < 3 ? shift[static_cast<Eigen::Index>(k)] : turn[static_cast<Eigen::Index>(k - 3)];
    const double tolerance = k < 3 ? position_tolerance : angle_tolerance;
    EXPECT_NEAR(c.component[k].mean, want, tolerance) << Comparison::names[k];
    EXPECT_NEAR(c.component[k].rms, std::abs(want), tolerance) << Comparison::names[k];
    EXPECT_NEAR(c.component[k].largest, std::abs(want), 2 * tolerance) << Comparison::names[k];
    EXPECT_NEAR(c.component[k].over_sigma, over[k], 0.003) << Comparison::names[k];
  }
  const core::Value v = core::reported(c);
  EXPECT_NEAR(v.find("heading")->find("rms_arcsec")->as_number(), 90.0, 0.01);
  EXPECT_NEAR(v.find("down")->find("mean_m")->as_number(), 0.05, 1e-4);
}

TEST(Compare, OnlyTheSpansCountAndRecordsOutsideTruthAreCounted) {
  const Trajectory truth(flight(100.0));
  core::TrajectoryData d = flight(50.0);
  for (size_t i = 0; i < d.size(); ++i) {
    d.time[i] += 10.0;  // the same motion later: an error along track everywhere
    if (i >= 2500 && i < 3000) d.height[i] += 70.0;
  }
  const core::TrajectoryErrors errors = errors_against(d, truth);
  EXPECT_EQ(errors.outside, 500u);
  EXPECT_EQ(errors.size() + errors.outside, d.size());
  const Comparison c = compare(errors, {{start + 60.0, start + 69.99}, {start + 80.0, start + 80.5}});
  EXPECT_EQ(c.compared, 500u + 26u);
  EXPECT_GT(c.component[2].rms, 60.0);
  EXPECT_NEAR(c.component[0].mean, -500.0, 5.0);
  EXPECT_EQ(c.component[0].over_sigma, 0.0);
  EXPECT_EQ(core::reported(c).find("north")->find("error_over_sigma"), nullptr);
  EXPECT_EQ(compare(errors, {{start - 20.0, start - 10.0}}).compared, 0u);
}

TEST(Compare, HeadingErrorsCrossNorth) {
  const Trajectory truth(flight(100.0));
  const core::TrajectoryErrors errors = errors_against(disturbed(flight(100.0), Vector3d::Zero(), {0, 0, -0.01}), truth);
  for (const Vector3d& e : errors.attitude) EXPECT_NEAR(e[2], -0.01, angle_tolerance);
}

}  // namespace
}  // namespace swath::trajectory
