// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/target/target_readings.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <deque>

#include "core/config/units.h"

namespace swath::calib {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;

constexpr double second_order = 2e-7;  // rad: angles below 1e-3 against the swath's tangent and the rounding of pairs

struct Given {
  double heading, right, height;
  bool profile = false;
};

// Lines of level flight, with displacements by the linear model.
struct Lines {
  std::deque<TargetView> views;
  TargetMeasures m;
  double roll = 0.0, pitch = 0.0, heading = 0.0, range = 0.0, scale = 0.0, forward = 0.0;
  Vector3d datum{0, 0, 0};  // east, north, up
  double sigma = 0.02;

  void make(const std::vector<Given>& given) {
    const auto n = static_cast<Eigen::Index>(given.size());
    m.covariance = sigma * sigma * MatrixXd::Identity(3 * n, 3 * n);
    m.held = MatrixXd::Zero(3 * n, 6);
    m.widest = 0.36;
    for (const Given& g : given) {
      TargetView& v = views.emplace_back();
      v.seen = true;
      v.heading = g.heading;
      v.strain_across_sigma = 1e-3;
      LineMeasure l;
      l.line = static_cast<int>(m.lines.size()) + 1;
      l.view = &v;
      l.heading = g.heading;
      l.role = g.profile ? TargetRole::profile : std::abs(g.right) > 0.18 * g.height ? TargetRole::edge : TargetRole::nadir;
      l.target = {0.0, g.right, g.height};
      const double s = std::sin(g.heading), c = std::cos(g.heading);
      l.body_R_local << s, c, 0, c, -s, 0, 0, 0, -1;
      l.body_R_level = Vector3d(1, 1, -1).asDiagonal();
      l.by.setZero();
      for (int k = 0; k < 3; ++k) {
        l.by.col(boresight_roll + k) = Vector3d::Unit(k).cross(l.target);
        l.by.col(lever_forward + k) = Vector3d::Unit(k);
      }
      const Vector3d u = l.target.normalized();
      l.by.col(range_offset) = u;
      const double a = std::atan2(g.right, g.height);
      l.by.col(scan_scale) = a * Vector3d(0, g.height, -g.right);
      l.delta = l.by.col(0) * roll + l.by.col(1) * pitch + l.by.col(2) * heading + u * range + l.by.col(scan_scale) * scale +
                l.by.col(lever_forward) * forward + l.body_R_local * datum;
      v.strain_across = scale * (1.0 + 2.0 * a * std::tan(a));
      m.lines.push_back(l);
    }
  }
};

const double pi = core::pi;
std::vector<Given> pattern() { return {{0.3, 0, 700}, {0.3 + pi, 5, 700}, {0.3, 210, 700}, {0.3 + pi, 210, 700}, {0.3 + pi, -200, 700}}; }

TEST(TargetReadings, AnglesInTheirOrder) {
  Lines l;
  l.roll = 4e-4, l.pitch = -6e-4, l.heading = 8e-4, l.range = 0.07;
  l.datum = {0.3, -0.2, 0.0};
  l.make(pattern());
  const AngleReadings a = read_angles(l.m);
  ASSERT_TRUE(a.pitch.determined && a.roll.determined && a.heading.determined && a.range.determined);
  // What one angle lends another goes when the readings are repeated with the values applied: a hundredth of it is left here.
  EXPECT_NEAR(a.pitch.value, l.pitch, 1e-5);
  EXPECT_NEAR(a.roll.value, l.roll, 1e-5);
  EXPECT_NEAR(a.heading.value, l.heading, 2e-5);
  EXPECT_NEAR(a.range.value, l.range, 0.01);
  for (const Reading& r : a.heading.readings) EXPECT_NEAR(r.value, l.heading, 6e-5) << r.first << " " << r.second;
}

TEST(TargetReadings, SigmasAreThoseOfTheReadingsCovariance) {
  Lines l;
  l.make({{0.3, 0, 700}, {0.3 + pi, 0, 700}});
  const AngleReadings a = read_angles(l.m);
  ASSERT_EQ(a.pitch.readings.size(), 1u);
  EXPECT_NEAR(a.pitch.sigma, l.sigma / std::sqrt(2.0) / 700.0, second_order);
  EXPECT_NEAR(a.roll.sigma, l.sigma / std::sqrt(2.0) / 700.0, second_order);
  // An error that both lines share along their flight (latency) does not average out; one that both share in the map does.
  Lines shared;
  shared.make({{0.3, 0, 700}, {0.3 + pi, 0, 700}});
  for (Eigen::Index i : {0, 3}) shared.m.held(i, 5) = 0.05;
  EXPECT_NEAR(read_angles(shared.m).pitch.sigma, std::hypot(0.02 / std::sqrt(2.0), 0.05) / 700.0, second_order);
  Lines map;
  map.make({{0.3, 0, 700}, {0.3 + pi, 0, 700}});
  map.m.covariance(0, 0) = map.m.covariance(3, 3) += 0.05 * 0.05;
  map.m.covariance(0, 3) = map.m.covariance(3, 0) = -0.05 * 0.05;
  EXPECT_NEAR(read_angles(map.m).pitch.sigma, 0.02 / std::sqrt(2.0) / 700.0, second_order);
}

TEST(TargetReadings, ScatterCountsWhereItIsLarger) {
  Lines l;
  l.make({{0.3, 0, 700}, {0.3 + pi, 0, 700}, {0.3, 0, 700}, {0.3 + pi, 0, 700}, {0.3, 0, 700}, {0.3 + pi, 0, 700}});
  AngleReadings a = read_angles(l.m);
  EXPECT_EQ(a.pitch.readings.size(), 9u);
  EXPECT_EQ(a.pitch.sigma, a.pitch.own);
  l.m.lines[0].delta.x() += 0.4;
  l.m.lines[3].delta.x() -= 0.3;
  a = read_angles(l.m);
  EXPECT_GT(a.pitch.scatter, 2.0 * a.pitch.own);
  EXPECT_EQ(a.pitch.sigma, a.pitch.scatter);
}

TEST(TargetReadings, WhatThePassesDoNotTell) {
  Lines one_way;
  one_way.make({{0.3, 0, 700}, {0.3, 4, 700}, {0.3, 210, 700}});
  AngleReadings a = read_angles(one_way.m);
  EXPECT_FALSE(a.pitch.determined);
  EXPECT_FALSE(a.roll.determined);
  EXPECT_TRUE(a.heading.determined);  // one direction, different places in the swath
  Lines no_edge;
  no_edge.make({{0.3, 0, 700}, {0.3 + pi, 4, 700}});
  a = read_angles(no_edge.m);
  EXPECT_TRUE(a.pitch.determined);
  EXPECT_FALSE(a.heading.determined);
  Lines heights;
  heights.make({{0.3, 0, 700}, {0.3 + pi, 4, 1200}});
  EXPECT_FALSE(read_angles(heights.m).pitch.determined);
  Lines none;
  none.make({});
  EXPECT_FALSE(read_angles(none.m).range.determined);
}

TEST(TargetReadings, TwoHeightsTellTheLeverArmFromPitch) {
  for (const double forward : {0.0, 0.5}) {
    Lines l;
    l.pitch = 5e-4;
    l.forward = forward;
    auto given = pattern();
    for (const Given& g : pattern()) given.push_back({g.heading, g.right * 1200 / 700, 1200});
    l.make(given);
    const JointTarget j = solve_jointly(l.m, {});
    EXPECT_TRUE(j.two_heights);
    EXPECT_NEAR(j.pitch.value, l.pitch, 0.1 * j.pitch.sigma + second_order);
    EXPECT_NEAR(j.lever_forward.value, forward, 0.1 * j.lever_forward.sigma);
    EXPECT_LT(j.lever_forward.sigma, 0.05);
  }
  // At one height they are one.
  Lines l;
  l.pitch = 5e-4;
  l.make(pattern());
  const JointTarget j = solve_jointly(l.m, {});
  EXPECT_FALSE(j.two_heights);
  EXPECT_FALSE(j.lever_forward.free);
  EXPECT_NEAR(j.pitch.value, l.pitch, 0.05 * j.pitch.sigma + second_order);
}

TEST(TargetReadings, DatumRangeAndScaleTogether) {
  Lines l;
  l.roll = 3e-4, l.heading = -5e-4, l.range = 0.12, l.scale = 4e-4;
  l.datum = {0.3, -0.2, 0.0};
  l.make(pattern());
  const JointTarget j = solve_jointly(l.m, {});
  EXPECT_NEAR(j.datum.x(), 0.3, 0.1 * j.datum_sigma.x());
  EXPECT_NEAR(j.datum.y(), -0.2, 0.1 * j.datum_sigma.y());
  EXPECT_NEAR(j.range_offset.value, l.range, 0.1 * j.range_offset.sigma);
  EXPECT_NEAR(j.scan_scale.value, l.scale, 0.1 * j.scan_scale.sigma);
  EXPECT_NEAR(j.roll.value, l.roll, 0.1 * j.roll.sigma);
  EXPECT_NEAR(j.heading.value, l.heading, 0.1 * j.heading.sigma);
  EXPECT_LT(j.scan_scale.sigma, 3e-4);
}

}  // namespace
}  // namespace swath::calib
