// SPDX-License-Identifier: GPL-3.0-or-later
#include "trajectory/corrected.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/config/units.h"
#include "core/error.h"
#include "core/geo/frames.h"
#include "core/geo/geodesy.h"

namespace swath::trajectory {
namespace {

using Eigen::Vector3d;
using Knot = CorrectionSeries::Knot;
using Six = CorrectionSeries::Six;

constexpr double start = 1.4e9;  // GPS time, s

/// 100 s eastward at 50 m/s, one record per 0.5 s, heading through north by 0.001 rad/s.
core::TrajectoryData flight(bool extras = true) {
  core::TrajectoryData d;
  for (int k = 0; k <= 200; ++k) {
    const double t = 0.5 * k;
    d.time.push_back(start + t);
    d.latitude.push_back(0.8);
    d.longitude.push_back(0.2 + 50 * t / 4.45e6);
    d.height.push_back(700);
    d.roll.push_back(0.01), d.pitch.push_back(-0.02), d.heading.push_back(core::wrap_two_pi(-0.05 + 0.001 * t));
    if (!extras) continue;
    d.v_north.push_back(0), d.v_east.push_back(50), d.v_down.push_back(-1);
    for (auto* c : {&d.sigma_north, &d.sigma_east, &d.sigma_down, &d.sigma_roll, &d.sigma_pitch, &d.sigma_heading}) c->push_back(0.5F);
  }
  if (!extras) return d;
  d.covariance.time = {start};
  d.covariance.upper.resize(1);
  d.errors.resize(2, 3);
  return d;
}
Vector3d moved(const core::TrajectoryData& a, const core::TrajectoryData& b, size_t k) {
  const Vector3d step =
      core::ecef_of({b.latitude[k], b.longitude[k], b.height[k]}) - core::ecef_of({a.latitude[k], a.longitude[k], a.height[k]});
  return core::ecef_R_ned(a.latitude[k], a.longitude[k]).transpose() * step;
}

const Six first{0.1, -0.2, 0.3, 1e-4, -2e-4, 3e-4}, second{0.2, 0.2, -0.1, -1e-4, 4e-4, 1e-3}, third{-1, 0, 0, 0, 0, 0};
std::vector<CorrectionSeries> two_lines() {
  // Out of order; the first line from 10 to 30 s, the other from 60 s with one knot alone.
  return {{{Knot{start + 60, third, {}}}},
          {{Knot{start + 10, first, Six{1, 1, 1, 1, 1, 1}}, Knot{start + 30, second, Six{2, 2, 2, 2, 2, 4}}}}};
}

TEST(Corrected, IsLinearBetweenKnotsAndBetweenLines) {
  const CorrectionCurve curve(two_lines());
  const auto expect = [&](double t, double north, double rate, double heading) {
    const CorrectionCurve::Value v = curve.at(start + t);
    EXPECT_NEAR(v.value[0], north, 1e-12) << t;
    EXPECT_NEAR(v.rate[0], rate, 1e-12) << t;
    EXPECT_NEAR(v.value[5], heading, 1e-15) << t;
  };
  expect(-50, 0.1, 0, 3e-4);
  expect(10, 0.1, 0.005, 3e-4);
  expect(20, 0.15, 0.005, 6.5e-4);
  expect(30, 0.2, -0.04, 1e-3);
  expect(45, -0.4, -0.04, 5e-4);
  expect(60, -1, 0, 0);
  expect(99, -1, 0, 0);
  EXPECT_EQ(CorrectionCurve({}).at(start).value, Six{});
}

TEST(Corrected, MovesTurnsAndKeepsVelocitiesTheDerivative) {
  const core::TrajectoryData before = flight(), after = corrected(before, two_lines());
  const CorrectionCurve curve(two_lines());
  for (size_t k = 0; k < before.size(); ++k) {
    const CorrectionCurve::Value v = curve.at(before.time[k]);
    constexpr double millionth = 1e-8;  // m: rounding of ecef coordinates, some times
    EXPECT_LT((moved(before, after, k) - Vector3d(v.value[0], v.value[1], v.value[2])).norm(), millionth) << k;
    EXPECT_DOUBLE_EQ(after.roll[k], before.roll[k] + v.value[3]);
    EXPECT_DOUBLE_EQ(after.pitch[k], before.pitch[k] + v.value[4]);
    EXPECT_NEAR(core::wrap_pi(after.heading[k] - before.heading[k]), v.value[5], 1e-14);
    EXPECT_GE(after.heading[k], 0);
    EXPECT_LT(after.heading[k], 2 * core::pi);
    // Away from knots the velocity's change is the slope of the move.
    const double t = before.time[k] - start;
    if (k == 0 || k + 1 == before.size() || t == 10 || t == 30 || t == 60) continue;
    const Vector3d slope = moved(before, after, k + 1) - moved(before, after, k - 1);
    EXPECT_NEAR(after.v_north[k] - before.v_north[k], slope.x(), 1e-7);
    EXPECT_NEAR(after.v_east[k] - before.v_east[k], slope.y(), 1e-7);
    EXPECT_NEAR(after.v_down[k] - before.v_down[k], slope.z(), 1e-7);
  }
}

TEST(Corrected, ReplacesSigmasWhereStated) {
  const core::TrajectoryData d = corrected(flight(), two_lines());
  EXPECT_FLOAT_EQ(d.sigma_north[0], 1);      // before the first knot
  EXPECT_FLOAT_EQ(d.sigma_north[40], 1.5F);  // 20 s
  EXPECT_FLOAT_EQ(d.sigma_heading[40], 2.5F);
  EXPECT_FLOAT_EQ(d.sigma_heading[80], 0.5F);  // the knot at 60 s states none
  EXPECT_FLOAT_EQ(d.sigma_down[200], 0.5F);
  EXPECT_TRUE(d.covariance.empty());
  EXPECT_TRUE(d.errors.empty());
  // Columns that the trajectory does not have do not appear.
  const core::TrajectoryData bare = corrected(flight(false), two_lines());
  EXPECT_FALSE(bare.has_sigma());
  EXPECT_FALSE(bare.has_velocity());
}

TEST(Corrected, NothingChangesNothing) {
  const core::TrajectoryData before = flight(), after = corrected(before, {});
  EXPECT_EQ(after.latitude, before.latitude);
  EXPECT_EQ(after.heading, before.heading);
  EXPECT_EQ(after.errors.size(), 2u);
  EXPECT_EQ(after.covariance.time, before.covariance.time);
}

TEST(Corrected, TheResponseToTheCalibrationIsCarriedOn) {
  core::CalibrationResponse::Matrix one = core::CalibrationResponse::Matrix::Constant(1.0), two = 3.0 * one;
  EXPECT_TRUE(corrected(flight(), two_lines()).response.empty());
  std::vector<CorrectionSeries> lines = {{{Knot{start + 60, third, {}, two}}}, {{Knot{start + 10, first, {}, one}}}};
  const core::CalibrationResponse r = corrected(flight(), lines).response;
  EXPECT_EQ(r.time, (std::vector<double>{start + 10, start + 60}));
  EXPECT_EQ(r.at(start)(5, 10), 1.0);
  EXPECT_EQ(r.at(start + 35)(0, 0), 2.0);
  EXPECT_EQ(r.at(start + 99)(3, 0), 3.0);
  EXPECT_TRUE(core::CalibrationResponse{}.at(start).isZero(0.0));
  lines[0].knots[0].response.reset();
  EXPECT_TRUE(corrected(flight(), lines).response.empty());
}

std::string refused(std::vector<CorrectionSeries> corrections) {
  try {
    (void)corrected(flight(), corrections);
  } catch (const core::Error& e) {
    return e.text();
  }
  return "";
}

TEST(Corrected, RefusesWhatIsNoFunctionOfTime) {
  EXPECT_NE(refused({{}}).find("correction 1"), std::string::npos);
  EXPECT_NE(refused({{{Knot{1, first, {}}, Knot{1, first, {}}}}}).find("not later"), std::string::npos);
  EXPECT_NE(refused({{{Knot{1, first, {}}, Knot{5, first, {}}}}, {{Knot{5, first, {}}}}}).find("correction 2"), std::string::npos);
  Six broken = first;
  broken[4] = std::nan("");
  EXPECT_NE(refused({{{Knot{1, broken, {}}}}}).find("not finite"), std::string::npos);
  EXPECT_NE(refused({{{Knot{1, first, broken}}}}).find("not finite"), std::string::npos);
}

}  // namespace
}  // namespace swath::trajectory
