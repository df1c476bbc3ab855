// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/network/plane_factors.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/calib/network/plane_crossing.h"

namespace swath::calib {
namespace {

using namespace test;
using Eigen::VectorXd;

/// Scaled to what each unknown's own equation weighs.
double share_of_right_side(const Crossing& c, double& right) {
  PlaneFactors factors = c.factors();
  factors.linearise(*c.off, c.calibration);
  NetworkNormals normals(c.states->sizes());
  factors.add(*c.states, normals);
  VectorXd product = VectorXd::Zero(c.error.size());
  for (int a = 0; a < normals.N.nodes(); ++a)
    for (int b = 0; b <= a; ++b) {
      const auto B = normals.N.block(a, b);
      if (B.size() == 0) continue;
      product.segment(normals.N.first(a), normals.N.size(a)) += B * c.error.segment(normals.N.first(b), normals.N.size(b));
      if (a != b)
        product.segment(normals.N.first(b), normals.N.size(b)) += B.transpose() * c.error.segment(normals.N.first(a), normals.N.size(a));
    }
  const VectorXd scale = normals.N.diagonal().unaryExpr([](double d) { return d > 0 ? 1 / std::sqrt(d) : 0.0; });
  right = scale.cwiseProduct(normals.b).norm();
  return scale.cwiseProduct(product - normals.b).norm() / right;
}

/// Every Jacobian, the place of each unknown and the elimination of the planes are in this: the true error of states and calibration, with
/// the true planes, solves the equations but for terms of second order, which fall with the error's size.
TEST(PlaneFactors, TheTrueErrorSolvesTheEquations) {
  double right = 0, smaller = 0;
  const double whole = share_of_right_side(Crossing(1.0), right), tenth = share_of_right_side(Crossing(0.1), smaller);
  std::printf("left of the right side: %.2g, with a tenth of the error %.2g\n", whole, tenth);
  EXPECT_LT(whole, 0.02);
  EXPECT_LT(tenth, 0.004);
  EXPECT_NEAR(smaller / right, 0.1, 0.01);
}

TEST(PlaneFactors, TheFitBringsPlanesToTheirReturnsAndRoughnessIsWhatIsNotNoise) {
  Dice dice(3);
  Crossing c(0.0, &dice);
  for (TiePlane& p : c.ties.planes) p.centre += 0.3 * p.normal;
  PlaneFactors factors = c.factors();
  factors.fit(*c.off, c.calibration);
  factors.linearise(*c.off, c.calibration);
  for (const PlaneMisfit& m : factors.misfits()) {
    if (m.returns > 0) {
      EXPECT_LT(std::abs(m.mean), 0.03) << m.plane;
    }
    EXPECT_EQ(m.weight, 1.0);
  }
  EXPECT_NEAR(factors.noise_factor(), 1.0, 0.15);
}

/// Variance of a group's mean by the wander between instants, its returns at given shares of an interval.
double wander_of(const std::vector<double>& shares) {
  Crossing c(0.0);
  const TieGroup& g = c.ties.groups[0];
  const auto interval = std::upper_bound(c.times.begin(), c.times.end(), c.ties.returns.time[g.begin]) - c.times.begin();
  const double first = c.times[static_cast<size_t>(interval) - 1], dt = c.times[static_cast<size_t>(interval)] - first;
  for (std::uint32_t i = g.begin; i < g.end; ++i)
    c.ties.returns.time[i] = first + dt * shares[(i - g.begin) * shares.size() / (g.end - g.begin)];
  // They leave the plane: all keep their weight.
  PlaneFactors factors(c.ties, c.world.scanner, c.world.noise, c.times, c.unknown, {1e6, 2e6}, 0.0, 1e-10, 1);
  factors.linearise(*c.off, c.calibration);
  return factors.variance_between(0);
}

/// A Brownian bridge over a time T has the variance T / 4 in its middle, T / 12 in its mean, none at its ends.
TEST(PlaneFactors, WhatWandersBetweenInstantsIsAveragedOverAGroup) {
  const double middle = wander_of({0.5}), mean = wander_of({1 / 24., 3 / 24., 5 / 24., 7 / 24., 9 / 24., 11 / 24., 13 / 24., 15 / 24.,
                                                            17 / 24., 19 / 24., 21 / 24., 23 / 24.});
  std::printf("sigma by wander: %.2g m in the middle, %.2g m in the mean\n", std::sqrt(middle), std::sqrt(mean));
  EXPECT_GT(middle, 0.0);
  EXPECT_NEAR(middle / mean, 3.0, 0.3);
  EXPECT_NEAR(wander_of({0.001}) / middle, 0.004, 0.001);
}

TEST(PlaneFactors, AGroupFarFromItsPlaneLosesItsWeight) {
  Dice dice(3);
  Crossing c(0.0, &dice);
  const TieGroup& bad = c.ties.groups[4];
  for (std::uint32_t i = bad.begin; i < bad.end; ++i) c.ties.returns.range[i] += 1.0;
  PlaneFactors factors = c.factors();
  factors.linearise(*c.off, c.calibration);
  factors.weigh();
  const std::vector<PlaneMisfit> misfits = factors.misfits();
  EXPECT_EQ(misfits[4].weight, 0.0);
  EXPECT_EQ(factors.left_out(), 1u);
  size_t full = 0;
  for (const PlaneMisfit& m : misfits) full += m.weight == 1.0;
  EXPECT_GT(full, misfits.size() * 8 / 10);
}

TEST(PlaneFactors, ARejectedGroupTakesNoPartInTheFit) {
  Dice dice(3);
  Crossing c(0.0, &dice);
  const TieGroup& bad = c.ties.groups[4];
  for (std::uint32_t i = bad.begin; i < bad.end; ++i) c.ties.returns.range[i] += 1.0;
  PlaneFactors factors = c.factors();
  factors.reject(4);
  factors.fit(*c.off, c.calibration);
  factors.linearise(*c.off, c.calibration);
  const std::vector<PlaneMisfit> misfits = factors.misfits();
  EXPECT_GT(std::abs(misfits[4].mean), 0.7);  // the range's metre, along the normal
  size_t others = 0;
  for (size_t g = 0; g < misfits.size(); ++g) {
    if (g == 4 || misfits[g].plane != bad.plane) continue;
    EXPECT_LT(std::abs(misfits[g].mean), 0.03);
    ++others;
  }
  EXPECT_GT(others, 0u);
}

/// A trajectory without the other intervals gives the same equations.
TEST(PlaneFactors, IntervalsAreThoseOfTheReturns) {
  const Crossing c;
  PlaneFactors whole = c.factors(), part = c.factors();
  const std::vector<char> wanted = whole.intervals(c.calibration, 0.25);
  ASSERT_EQ(wanted.size(), c.times.size() - 1);
  EXPECT_LT(std::count(wanted.begin(), wanted.end(), 1), static_cast<std::ptrdiff_t>(wanted.size()));
  const core::TrajectoryData& all = c.off->data();
  trajectory::PoseRecords poses;
  for (size_t i = 0; i < all.size(); ++i) {
    const auto next = std::upper_bound(c.times.begin(), c.times.end(), all.time[i]) - c.times.begin();
    if (!wanted[static_cast<size_t>(std::clamp<std::ptrdiff_t>(next - 1, 0, static_cast<std::ptrdiff_t>(wanted.size()) - 1))]) continue;
    const auto pose = c.off->pose_at(all.time[i]);
    poses.time.push_back(all.time[i]);
    poses.position.push_back(pose->position);
    poses.ecef_R_body.push_back(pose->ecef_R_body);
  }
  ASSERT_LT(poses.time.size(), all.size());
  whole.linearise(*c.off, c.calibration);
  part.linearise(trajectory::Trajectory(poses), c.calibration);
  constexpr double same = 1e-6;  // a span's ends have another cubic, beyond the margin
  size_t used = 0;
  for (size_t g = 0; g < whole.groups(); ++g) {
    const GroupBlock &a = whole.block(g), &b = part.block(g);
    used += a.used > 0 ? 1 : 0;
    EXPECT_EQ(b.used, a.used);
    ASSERT_EQ(b.index, a.index);
    EXPECT_LE((b.N - a.N).norm(), same * a.N.norm());
    EXPECT_LE((b.b - a.b).norm(), same * a.b.norm());
    EXPECT_NEAR(b.c, a.c, same * a.c);
  }
  EXPECT_GT(used, whole.groups() / 2);

  // Times of returns count with their latency: two seconds move them by four intervals.
  core::Calibration late = c.calibration;
  late.latency.value += 2.0;
  const std::vector<char> moved = whole.intervals(late, 0.25);
  const auto first = [](const std::vector<char>& v) { return std::find(v.begin(), v.end(), 1) - v.begin(); };
  EXPECT_NEAR(static_cast<double>(first(moved) - first(wanted)), 4.0, 1.0);
}

/// A solution moves the planes that were eliminated: with everything else held, to where the returns are.
TEST(PlaneFactors, PlanesFollowTheSolution) {
  Crossing c(0.0);
  for (TiePlane& p : c.ties.planes) p.centre += 0.1 * p.normal;
  PlaneFactors factors = c.factors();
  factors.linearise(*c.off, c.calibration);
  NetworkNormals normals(c.states->sizes());
  factors.add(*c.states, normals);
  factors.follow(VectorXd::Zero(c.error.size()), *c.states);
  for (const PlaneMisfit& m : factors.misfits()) {
    const size_t k = m.plane;
    EXPECT_NEAR(factors.planes()[k].normal.dot(factors.planes()[k].centre - c.world.planes[k].centre), 0.0, 2e-3) << k;
  }
}

}  // namespace
}  // namespace swath::calib
