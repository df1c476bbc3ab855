// SPDX-License-Identifier: GPL-3.0-or-later
#include "trajectory/trajectory.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"
#include "core/geo/frames.h"
#include "core/geo/geodesy.h"

namespace swath::trajectory {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double deg = core::degree;
constexpr double start = 1.4e9;  // a GPS time of this century: its rounding is part of the test

// An aircraft in turbulence, in closed form: latitude, longitude, height, roll, pitch, heading at s seconds.
struct Flight {
  double frequency = 2.0;  // Hz
  double roll_amplitude = 2.0 * deg;
  double heading0 = 0.3 * deg;  // the heading swings through north
  double longitude0 = 11.0 * deg;
  Vector3d geodetic(double s) const {
    const double w = 2.0 * core::pi * frequency;
    return {47.0 * deg + 60.0 / 6.37e6 * s, longitude0 + 5.0 / 6.37e6 * s + 0.05 / 6.37e6 * std::sin(w * s),
            1500.0 + 0.1 * std::sin(w * s + 0.4)};
  }
  core::Attitude attitude(double s) const {
    const double w = 2.0 * core::pi * frequency;
    return {roll_amplitude * std::sin(w * s), 3.0 * deg + 1.0 * deg * std::sin(w * s + 1.0), heading0 + 1.0 * deg * std::cos(w * s)};
  }
  Vector3d ecef(double s) const {
    const Vector3d g = geodetic(s);
    return core::ecef_of({g[0], g[1], g[2]});
  }
  Matrix3d ecef_R_body(double s) const {
    const Vector3d g = geodetic(s);
    return core::ecef_R_ned(g[0], g[1]) * core::matrix_of(attitude(s));
  }
};

// Recorded times are rounded to the double grid of GPS time; the motion is taken at the rounded time.
core::TrajectoryData sampled(const Flight& f, double seconds, double rate) {
  core::TrajectoryData d;
  for (int i = 0; i <= static_cast<int>(seconds * rate); ++i) {
    const double t = start + i / rate;
    const double s = t - start;
    const Vector3d g = f.geodetic(s);
    const core::Attitude a = f.attitude(s);
    d.time.push_back(t);
    d.latitude.push_back(g[0]);
    d.longitude.push_back(g[1]);
    d.height.push_back(g[2]);
    d.roll.push_back(a.roll);
    d.pitch.push_back(a.pitch);
    d.heading.push_back(core::wrap_two_pi(a.heading));
  }
  return d;
}

struct Errors {
  double position = 0.0, attitude = 0.0, velocity = 0.0, rate = 0.0;
};

Errors worst(const Trajectory& t, const Flight& f, double from, double to) {
  Errors e;
  constexpr double h = 1e-4;
  for (double s = from; s <= to; s += 0.00137) {
    const double time = start + s;
    const double at = time - start;
    const auto p = t.pose_at(time);
    EXPECT_TRUE(p.has_value());
    if (!p) return e;
    e.position = std::max(e.position, (p->position - f.ecef(at)).norm());
    e.attitude = std::max(e.attitude, core::log_so3(p->ecef_R_body.transpose() * f.ecef_R_body(at)).norm());
    e.velocity = std::max(e.velocity, (p->velocity - (f.ecef(at + h) - f.ecef(at - h)) / (2 * h)).norm());
    const Vector3d rate = core::log_so3(f.ecef_R_body(at - h).transpose() * f.ecef_R_body(at + h)) / (2 * h);
    e.rate = std::max(e.rate, (p->rate - rate).norm());
  }
  return e;
}

TEST(Trajectory, TurbulenceKeepsATenthOfAMillimetreAtOneKilometre) {
  const Flight f;
  const Trajectory t(sampled(f, 4.0, 200.0));
  const Errors inside = worst(t, f, 0.005, 3.994);
  constexpr double tenth_mm_per_km = 1e-7;
  EXPECT_LT(inside.attitude, 0.2 * tenth_mm_per_km);  // 0.02 mm at 1 km
  EXPECT_LT(inside.position, 1e-6);                   // 3.7e-7 of 0.1 m, and 6e-8 s of rounding at 60 m/s left over
  const Errors ends = worst(t, f, 0.0, 0.005);
  EXPECT_LT(ends.attitude, tenth_mm_per_km);
  RecordProperty("attitude_error_nrad", static_cast<int>(inside.attitude * 1e9));
  RecordProperty("attitude_error_at_ends_nrad", static_cast<int>(ends.attitude * 1e9));
}

TEST(Trajectory, VelocityAndBodyRates) {
  const Flight f;
  const Errors e = worst(Trajectory(sampled(f, 2.0, 200.0)), f, 0.01, 1.98);
  EXPECT_LT(e.velocity, 1e-4);  // central differences of 6.4e6 m coordinates over 0.2 ms: 1e-5 m/s; the cubic's own error 3e-5
  EXPECT_LT(e.rate, 1e-5);
}

TEST(Trajectory, HeadingAcrossNorthAndLongitudeAcross180) {
  Flight f;
  f.longitude0 = 179.99999 * deg;
  f.heading0 = 180.0 * deg;
  core::TrajectoryData d = sampled(f, 2.0, 200.0);
  for (double& h : d.heading) h = core::wrap_pi(h);
  for (double& l : d.longitude) l = core::wrap_pi(l);
  EXPECT_LT(worst(Trajectory(d), f, 0.005, 1.99).attitude, 2e-8);
  EXPECT_LT(worst(Trajectory(d), f, 0.005, 1.99).position, 1e-6);
}

TEST(Trajectory, RecordsAreMetExactly) {
  const Flight f;
  const core::TrajectoryData d = sampled(f, 0.1, 200.0);
  const Trajectory t(d);
  for (const double time : d.time) {
    const auto p = t.pose_at(time);
    ASSERT_TRUE(p);
    EXPECT_LT((p->position - f.ecef(time - start)).norm(), 2e-9);
    EXPECT_LT(core::log_so3(p->ecef_R_body.transpose() * f.ecef_R_body(time - start)).norm(), 1e-14);
  }
}

TEST(Trajectory, GapsAreNotInterpolatedOver) {
  core::TrajectoryData d = sampled(Flight{}, 2.0, 100.0);
  const auto cut = [](std::vector<double>& c) { c.erase(c.begin() + 51, c.begin() + 100); };
  for (auto* c : {&d.time, &d.latitude, &d.longitude, &d.height, &d.roll, &d.pitch, &d.heading}) cut(*c);
  const Trajectory t(d, {core::Seconds(0.1)});
  ASSERT_EQ(t.spans().size(), 2u);
  EXPECT_EQ(t.spans()[0], (Span{start, start + 0.5}));
  EXPECT_EQ(t.spans()[1], (Span{start + 1.0, start + 2.0}));
  EXPECT_TRUE(t.covers(start));
  EXPECT_TRUE(t.covers(start + 0.5));
  EXPECT_FALSE(t.covers(start + 0.501));
  EXPECT_FALSE(t.pose_at(start + 0.75).has_value());
  EXPECT_TRUE(t.covers(start + 2.0));
  EXPECT_FALSE(t.covers(start + 2.001));
  EXPECT_FALSE(t.covers(start - 0.001));
  // No record from beyond the gap is used: 100 Hz, one-sided cubic.
  EXPECT_LT(worst(t, Flight{}, 1.0, 1.02).attitude, 2e-6);
  EXPECT_LT(worst(t, Flight{}, 0.48, 0.4999).attitude, 2e-6);
}

TEST(Trajectory, ShortSpansUseWhatTheyHave) {
  const core::TrajectoryData d = sampled(Flight{}, 0.005, 200.0);
  ASSERT_EQ(d.size(), 2u);
  const auto p = Trajectory(d).pose_at(start + 0.0025);
  ASSERT_TRUE(p);
  EXPECT_LT((p->position - Flight{}.ecef(0.0025)).norm(), 1e-4);  // a line: 0.1 m * (2 pi 2)^2 * h^2 / 8 = 5e-5 m
}

TEST(Trajectory, CursorAgreesWithPoseAtInAnyOrder) {
  const core::TrajectoryData d = sampled(Flight{}, 1.0, 200.0);
  const Trajectory t(d);
  Cursor c(t);
  for (const double s : {0.0, 0.001, 0.0049, 0.005, 0.0051, 0.5, 0.4, 0.999, 1.0, 0.0}) {
    ASSERT_TRUE(c.seek(start + s)) << s;
    EXPECT_EQ(c.pose(start + s).position, t.pose_at(start + s)->position) << s;
  }
  EXPECT_FALSE(c.seek(start - 1.0));
  EXPECT_FALSE(c.seek(start + 1.1));
  EXPECT_TRUE(c.seek(start + 0.2));
}

TEST(Trajectory, SigmaIsLinearBetweenRecords) {
  core::TrajectoryData d = sampled(Flight{}, 0.01, 100.0);
  EXPECT_EQ(Trajectory(d).sigma_at(start).north, 0.0);
  d.sigma_north = {0.02f, 0.04f};
  d.sigma_east = d.sigma_down = {0.1f, 0.1f};
  d.sigma_roll = d.sigma_pitch = {1e-4f, 1e-4f};
  d.sigma_heading = {1e-4f, 3e-4f};
  const Trajectory t(d);
  EXPECT_NEAR(t.sigma_at(start + 0.005).north, 0.03, 1e-5);  // GPS time is rounded to 0.24 us
  EXPECT_NEAR(t.sigma_at(start + 0.0025).heading, 1.5e-4, 1e-7);
}

TEST(Trajectory, ThroughPosesItIsThatOfTheAngles) {
  const core::TrajectoryData d = sampled(Flight{}, 2.0, 200.0);
  PoseRecords poses;
  for (size_t i = 0; i < d.size(); ++i) {
    if (i > 100 && i < 200) continue;
    poses.time.push_back(d.time[i]);
    poses.position.push_back(core::ecef_of({d.latitude[i], d.longitude[i], d.height[i]}));
    poses.ecef_R_body.push_back(core::ecef_R_ned(d.latitude[i], d.longitude[i]) * core::matrix_of({d.roll[i], d.pitch[i], d.heading[i]}));
  }
  const Trajectory angles(d), through(poses);
  EXPECT_EQ(through.spans().size(), 2u) << "what was left out is a gap";
  EXPECT_FALSE(through.has_sigma());
  const double inside = d.time[50] + 0.001, gap = d.time[150];
  EXPECT_FALSE(through.covers(gap));
  EXPECT_EQ(through.pose_at(inside)->position, angles.pose_at(inside)->position);
  EXPECT_EQ(through.pose_at(inside)->ecef_R_body, angles.pose_at(inside)->ecef_R_body);
  const auto refused = [&](const auto& spoil) {
    PoseRecords bad = poses;
    spoil(bad);
    EXPECT_THROW(Trajectory{std::move(bad)}, core::Error);
  };
  refused([](PoseRecords& p) { std::swap(p.time[3], p.time[4]); });
  refused([](PoseRecords& p) { p.position[5].y() = std::nan(""); });
  refused([](PoseRecords& p) { p.ecef_R_body[5](1, 2) = std::nan(""); });
  refused([](PoseRecords& p) { p.time.pop_back(); });
}

void expect_error(core::TrajectoryData d, const std::string& where, const std::string& what) {
  try {
    Trajectory t(std::move(d), {}, "a.sbet");
    ADD_FAILURE() << "accepted: " << what;
  } catch (const core::Error& e) {
    EXPECT_EQ(e.where(), where);
    EXPECT_NE(std::string(e.what()).find(what), std::string::npos) << e.what();
  }
}

TEST(Trajectory, BadRecordsAreNamed) {
  const core::TrajectoryData good = sampled(Flight{}, 0.05, 200.0);
  core::TrajectoryData d = good;
  d.time[4] = d.time[3];
  expect_error(d, "a.sbet: record 4", "time does not increase");
  d = good;
  d.pitch[7] = std::nan("");
  expect_error(d, "a.sbet: record 7", "pitch");
  d = good;
  d.latitude[2] = 47.0;
  expect_error(d, "a.sbet: record 2", "latitude");
  d = good;
  d.heading.pop_back();
  expect_error(d, "a.sbet", "heading has 10 entries");
  expect_error(core::TrajectoryData{}, "a.sbet", "no two of its 0 records");
  d = good;
  for (size_t i = 0; i < d.size(); ++i) d.time[i] = start + static_cast<double>(i);
  expect_error(d, "a.sbet", "max_gap (0.1 s)");
}

}  // namespace
}  // namespace swath::trajectory
