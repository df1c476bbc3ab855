// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/gnss/fix_list.h"

#include <cmath>

#include "core/error.h"
#include "core/geo/geodesy.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

using core::FixQuality;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double latitude = 0.8, longitude = -1.8;
constexpr double rounding = 1e-12;  // m^2

Fix fix_at(double t, double height = 500) {
  Fix f;
  f.time = t;
  f.position = core::ecef_of({latitude, longitude, height});
  f.quality = FixQuality::fixed;
  return f;
}

Matrix3d neu_of(const Matrix3d& ecef) {
  Matrix3d R = core::ecef_R_ned(latitude, longitude);
  R.col(2) *= -1;
  return R.transpose() * ecef * R;
}

class Fixes : public ::testing::Test {
 protected:
  FixList list(bool may_go_back = false) { return {file_, "a", 0.5, may_go_back, tally_}; }
  GnssFile file_;
  core::Tally tally_;
};

TEST_F(Fixes, QualityByNumber) {
  EXPECT_EQ(quality_of_rtklib(1), FixQuality::fixed);
  EXPECT_EQ(quality_of_rtklib(2), FixQuality::float_ambiguity);
  EXPECT_EQ(quality_of_rtklib(3), FixQuality::sbas);
  EXPECT_EQ(quality_of_rtklib(4), FixQuality::differential);
  EXPECT_EQ(quality_of_rtklib(5), FixQuality::single);
  EXPECT_EQ(quality_of_rtklib(6), FixQuality::ppp);
  for (const double odd : {0.0, 7.0, -1.0, 1.5, std::nan("")}) EXPECT_EQ(quality_of_rtklib(odd), FixQuality::unknown);
}

TEST_F(Fixes, LatencyAndSigmasByQuality) {
  FixList l = list();
  double t = 1.4e9;
  for (const FixQuality q : {FixQuality::fixed, FixQuality::float_ambiguity, FixQuality::single}) {
    Fix f = fix_at(t++);
    f.quality = q;
    f.satellites = 300;
    l.add(f, 1);
  }
  const core::GnssData g = l.finish();
  EXPECT_EQ(g.time[0], 1.4e9 + 0.5);
  EXPECT_EQ(g.satellites[0], 255);
  EXPECT_FALSE(g.has_velocity());
  const double expected[3][2] = {{0.02, 0.04}, {0.3, 0.6}, {3, 6}};
  for (size_t i = 0; i < 3; ++i) {
    const Matrix3d c = neu_of(g.covariance[i]);
    EXPECT_NEAR(std::sqrt(c(0, 0)), expected[i][0], rounding);
    EXPECT_NEAR(std::sqrt(c(1, 1)), expected[i][0], rounding);
    EXPECT_NEAR(std::sqrt(c(2, 2)), expected[i][1], rounding);
  }
  EXPECT_EQ(tally_.of("GNSS files without sigmas of their own: those of the survey taken"), 1u);
  EXPECT_EQ(tally_.of("GNSS fixes: float"), 1u);
}

TEST_F(Fixes, SigmasThatSayThatNothingIsKnown) {
  FixList l = list();
  for (int k = 0; k < 4; ++k) {
    Fix f = fix_at(1.4e9 + k);
    const double position = k == 1 ? 1e6 : 0.02, velocity = k == 2 ? 1e6 : 0.05;  // m, m/s
    f.covariance = position * position * Matrix3d::Identity();
    f.velocity = Vector3d(1, 2, 3);
    f.velocity_covariance = velocity * velocity * Matrix3d::Identity();
    l.add(f, 1);
  }
  const core::GnssData g = l.finish();
  ASSERT_EQ(g.size(), 3u);
  EXPECT_EQ(g.time[1], 1.4e9 + 2.5);
  EXPECT_TRUE(g.velocity[1].array().isNaN().all());
  EXPECT_EQ(g.velocity[2], Vector3d(1, 2, 3));
  EXPECT_EQ(tally_.of("GNSS fixes with a sigma over 100 km, left out"), 1u);
  EXPECT_EQ(tally_.of("GNSS velocities with a sigma over 100 km/s, left out"), 1u);
}

TEST_F(Fixes, CovariancesThatAreNone) {
  FixList l = list();
  Matrix3d good, zero = Matrix3d::Zero(), crossed;
  good << 4, 1, 0, 1, 9, 0, 0, 0, 16;
  zero.diagonal() << 1, 1, 0;
  crossed << 4, 7, 0, 7, 9, 0, 0, 0, 16;
  double t = 1.4e9;
  for (const Matrix3d& m : {good, zero, crossed}) {
    Fix f = fix_at(t++);
    f.covariance = ecef_covariance(m * 1e-4, latitude, longitude);
    l.add(f, 7);
  }
  const core::GnssData g = l.finish();
  EXPECT_NEAR((neu_of(g.covariance[0]) - 1e-4 * good).norm(), 0, rounding);
  EXPECT_NEAR((neu_of(g.covariance[1]).diagonal() - Vector3d(4e-4, 4e-4, 16e-4)).norm(), 0, rounding);
  EXPECT_NEAR((neu_of(g.covariance[2]) - Matrix3d(Vector3d(4e-4, 9e-4, 16e-4).asDiagonal())).norm(), 0, rounding);
  EXPECT_EQ(tally_.of("GNSS position sigmas missing, zero or less: those of the survey are taken"), 1u);
  EXPECT_EQ(tally_.of("GNSS position covariances that are not positive definite: their variances alone are taken"), 1u);
}

TEST_F(Fixes, WhatIsLeftOutAndWhatIsRefused) {
  FixList l = list(true);
  for (int i = 0; i < 100; ++i) l.add(fix_at(1.4e9 + i + (i > 60 ? 5 : 0)), 1);
  Fix nowhere = fix_at(1.4e9 + 200);
  nowhere.position.x() = std::nan("");
  l.add(nowhere, 101);
  l.add(fix_at(1.4e9 + 104), 102);
  l.add(fix_at(1.4e9 + 99), 103);
  l.add(fix_at(1.4e9 + 106, 900), 104);
  const core::GnssData g = l.finish();
  EXPECT_EQ(g.size(), 101u);
  EXPECT_EQ(tally_.of("GNSS fixes with a value that is empty or not finite, left out"), 1u);
  EXPECT_EQ(tally_.of("GNSS fixes at a repeated time, left out"), 1u);
  EXPECT_EQ(tally_.of("GNSS fixes whose time goes back, left out"), 1u);
  EXPECT_EQ(tally_.of("GNSS gaps"), 2u);

  FixList strict = list();
  strict.add(fix_at(1.4e9), 1);
  strict.add(fix_at(1.4e9 - 2), 2);
  try {
    strict.finish();
    FAIL();
  } catch (const core::Error& e) {
    EXPECT_EQ(e.where(), "a:2");
    EXPECT_NE(std::string(e.what()).find("back by 2 s"), std::string::npos);
  }
  FixList kilometres = list();
  for (int i = 0; i < 20; ++i) {
    Fix f = fix_at(1.4e9 + i);
    f.position /= 1000;
    kilometres.add(f, 3);
  }
  EXPECT_THROW(kilometres.finish(), core::Error);
  EXPECT_THROW(list().finish(), core::Error);
  FixList bad = list();
  for (int i = 0; i < 20; ++i) bad.add(i % 5 ? fix_at(1.4e9 + i) : nowhere, 1);
  EXPECT_THROW(bad.finish(), core::Error);
}

TEST_F(Fixes, OneWildFixIsLeftOutAndCounted) {
  for (const size_t at : {size_t{0}, size_t{50}, size_t{99}})
    for (int kind = 0; kind < 4; ++kind) {
      tally_ = {};
      FixList l = list();
      for (size_t i = 0; i < 100; ++i) {
        Fix f = fix_at(1.4e9 + 0.2 * static_cast<double>(i));
        if (i == at && kind == 0) f.position.x() = 1e9;
        if (i == at && kind == 1) f.position.x() = -f.position.x();
        if (i == at && kind == 2) f.position *= 1.001;
        if (i == at && kind == 3) f.time += 1e5;
        l.add(f, static_cast<std::uint64_t>(i));
      }
      EXPECT_EQ(l.finish().size(), 99u) << at << ' ' << kind;
      EXPECT_EQ(tally_.left_out(), 1u) << at << ' ' << kind;
    }
}

TEST_F(Fixes, JumpsAndVelocities) {
  FixList l = list();
  for (int i = 0; i < 10; ++i) {
    Fix f = fix_at(1.4e9 + i, i == 5 ? 2000 : 500);
    if (i == 3) f.velocity = ecef_vector({1, 2, 3}, latitude, longitude);
    l.add(f, 1);
  }
  const core::GnssData g = l.finish();
  EXPECT_EQ(tally_.of("GNSS fixes farther from the one before than 500 m/s make"), 2u);
  ASSERT_TRUE(g.has_velocity());
  EXPECT_TRUE(std::isnan(g.velocity[0].x()));
  EXPECT_NEAR(g.velocity[3].norm(), std::sqrt(14.0), rounding);
  EXPECT_NEAR(g.velocity_covariance[3](0, 0), 0.05 * 0.05, rounding);
}

}  // namespace
}  // namespace swath::io
