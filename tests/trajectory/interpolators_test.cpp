// SPDX-License-Identifier: GPL-3.0-or-later
#include "trajectory/interpolators.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/trajectory/made_flight.h"

namespace swath::trajectory {
namespace {

TEST(Interpolators, PositionsAreThoseOfTheirOwnForms) {
  const PointTrack track = track_of(test::MadeFlight(1).fixes(60, 1.0), {}, {});
  const FixWindow w = window_at(track.fixes.time, 30.4, 5, track.longest_step);
  const KinematicOptions o;
  EXPECT_EQ(estimate_at(track, w, 30.4, Interpolator::kalman, o).state.x, interpolate(track.fixes, w, 30.4, o).x);
  EXPECT_EQ(estimate_at(track, w, 30.4, Interpolator::line, o).state.x, polynomial_at(track.fixes, w, 30.4, 1, o).x);
  EXPECT_EQ(estimate_at(track, w, 30.4, Interpolator::parabola, o).state.x, polynomial_at(track.fixes, w, 30.4, 2, o).x);
  EXPECT_EQ(estimate_at(track, w, 30.4, Interpolator::rts, o).state.x, track.smoother.at(30.4).x);
}

TEST(Interpolators, WhatIsOffTheSmootherIsPartOfTheError) {
  const PointTrack track = track_of(test::MadeFlight(1).fixes(60, 1.0), {}, {});
  const FixWindow w = window_at(track.fixes.time, 30.4, 5, track.longest_step);
  const Estimate line = estimate_at(track, w, 30.4, Interpolator::line, {}), best = estimate_at(track, w, 30.4, Interpolator::rts, {});
  const PointState::Vector6 off = line.state.x - best.state.x;
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(line.error(i, i), best.error(i, i) + off[i] * off[i], 1e-12) << i;
}

TEST(Interpolators, SigmaIsTrueOverSeedsOnStraightFlight) {
  std::array<Eigen::Vector3d, interpolators.size()> square;
  square.fill(Eigen::Vector3d::Zero());
  double n = 0.0;
  for (std::uint64_t seed = 21; seed <= 30; ++seed) {
    test::MadeFlight flight(seed);
    const PointTrack track = track_of(flight.fixes(200, 2.0, 0.0), {}, {});
    for (double t = 5.2; t < 90.0; t += 1.37, ++n)
      for (size_t k = 0; k < interpolators.size(); ++k) {
        const FixWindow w = window_at(track.fixes.time, t, 5, track.longest_step);
        const Estimate e = estimate_at(track, w, t, interpolators[k], {});
        const Eigen::Matrix3d total = e.error.topLeftCorner<3, 3>() + track.model().slow_of(stated_at(track.fixes, t));
        square[k] += (e.state.position() - flight.position(t)).cwiseAbs2().cwiseQuotient(total.diagonal());
      }
  }
  // White errors, though the model expects some of them to be slow.
  for (size_t k = 0; k < interpolators.size(); ++k)
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(std::sqrt(square[k][axis] / n), 1.0, 0.2) << title_of(interpolators[k]) << axis;
}

TEST(Interpolators, StatedCovarianceIsBetweenThoseOfTheFixes) {
  PointFixes fixes = test::MadeFlight(1).fixes(4, 1.0);
  fixes.time = {0, 1, 2, 3};
  fixes.covariance[1] = Eigen::Matrix3d::Identity();
  fixes.covariance[2] = 3.0 * Eigen::Matrix3d::Identity();
  EXPECT_NEAR(stated_at(fixes, 1.25)(0, 0), 1.5, 1e-12);
  EXPECT_EQ(stated_at(fixes, -1.0), fixes.covariance[0]);
  EXPECT_EQ(stated_at(fixes, 9.0), fixes.covariance[3]);
}

}  // namespace
}  // namespace swath::trajectory
