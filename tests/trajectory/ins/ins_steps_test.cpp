// SPDX-License-Identifier: GPL-3.0-or-later
#include "trajectory/ins/ins_steps.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "tests/trajectory/ins_problem.h"

namespace swath::trajectory {
namespace {

using Eigen::Vector3d;
using test::InsProblem;

InsProblem::Setup all_measured() {
  InsProblem::Setup setup;
  setup.layout = Layout(true, true, true, true, true);
  setup.fixes.velocity = true;
  return setup;
}

/// Steps for differences: what each state's error may be.
StateVector steps_of(const Layout& l) {
  StateVector out = StateVector::Constant(l.size, 1e-4);
  out.segment<3>(l.attitude).setConstant(1e-4);
  out.segment<3>(l.gyro_bias).setConstant(1e-5);
  return out;
}

TEST(InsSteps, DesignsAreDerivatives) {
  const InsProblem made(test::motion_of(test::survey_flight(2)), all_measured());
  size_t node = 12;
  while (made.nodes[node].fix < 0) ++node;
  const auto fix = static_cast<size_t>(made.nodes[node].fix);
  Estimate at = made.start(node);
  const Vector3d rate(0.02, -0.01, 0.03);
  const Problem& p = *made.problem;
  const StateVector size = steps_of(p.layout);
  const auto expect = [&](const char* what, const Eigen::MatrixXd& design, const auto& residual) {
    for (int j = 0; j < p.layout.size; ++j) {
      StateVector step = StateVector::Zero(p.layout.size);
      step[j] = size[j];
      Estimate plus = at, minus = at;
      plus.correct(p.layout, step);
      minus.correct(p.layout, -step);
      // The body's rate is what the gyros sense less their bias.
      Vector3d turned = Vector3d::Zero();
      if (j >= Layout::gyro_bias && j < Layout::force_bias) turned[j - Layout::gyro_bias] = -size[j];
      const Eigen::VectorXd column = (residual(minus, Vector3d(rate - turned)) - residual(plus, Vector3d(rate + turned))) / (2 * size[j]);
      constexpr double rounding = 4e-9 / 1e-5;  // of a position of 6e6 m, by the smallest step
      for (int i = 0; i < design.rows(); ++i)
        EXPECT_NEAR(column[i], design(i, j), rounding + 2e-3 * std::abs(design(i, j))) << what << ": row " << i << ", column " << j;
    }
  };
  const Observation<3> position = observed_position(p, fix, at, rate);
  expect("position", position.design, [&](const Estimate& e, const Vector3d& r) { return observed_position(p, fix, e, r).residual; });
  expect("velocity", observed_velocity(p, fix, at, rate)->design,
         [&](const Estimate& e, const Vector3d& r) { return observed_velocity(p, fix, e, r)->residual; });
  expect("standstill", observed_standstill(p, at).design,
         [&](const Estimate& e, const Vector3d&) { return observed_standstill(p, e).residual; });
  expect("wheels", observed_wheels(p, at, rate)->design,
         [&](const Estimate& e, const Vector3d& r) { return observed_wheels(p, e, r)->residual; });
}

TEST(InsSteps, APassageCarriesTheEstimateAndItsNoise) {
  const InsProblem made(test::motion_of(test::survey_flight(2)), all_measured());
  const Problem& p = *made.problem;
  Estimate e;
  e.nav = test::nav_at(made.motion, 0.0);
  e.fix = Vector3d(1, -2, 0.5);
  ImuWalk walk(p.path, e.nav.time);
  const double until = e.nav.time + 0.5;
  const Passage passage = passage_to(p, e, walk, until);
  // Within what a tactical IMU's noise makes in half a second.
  EXPECT_LT((passage.carried.nav.position - test::nav_at(made.motion, 0.5).position).norm(), 2e-3);
  EXPECT_NEAR(walk.time(), until, 1e-9);
  EXPECT_NEAR(passage.carried.fix.x(), std::exp(-0.5 / p.noise.fix_time), 1e-9);
  ASSERT_TRUE(passage.rate);
  // Half of the variance before, half after; with a P before it, what the filter's prediction makes.
  const StateMatrix P = made.covariance(), phi = passage.transition;
  StateMatrix by_filter = P;
  by_filter.diagonal() += 0.5 * passage.gained;
  by_filter = (phi * by_filter * phi.transpose()).eval();
  by_filter.diagonal() += 0.5 * passage.gained;
  const StateMatrix by_noise = phi * P * phi.transpose() + passage.noise();
  EXPECT_LT((by_filter - by_noise).cwiseAbs().maxCoeff(), 1e-12 * by_filter.cwiseAbs().maxCoeff());
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> values(Eigen::MatrixXd(passage.noise()), Eigen::EigenvaluesOnly);
  EXPECT_GT(values.eigenvalues().minCoeff(), -1e-15);
  // No time passes.
  const Passage none = passage_to(p, e, walk, walk.time());
  EXPECT_FALSE(none.rate);
  EXPECT_EQ(none.transition, StateMatrix::Identity(p.layout.size, p.layout.size));
  EXPECT_EQ(none.gained.cwiseAbs().maxCoeff(), 0.0);
}

TEST(InsSteps, WheelsAreUsedOnlyWhereTheyRollStraight) {
  const InsProblem made(test::motion_of(test::survey_flight(2)), all_measured());
  const Estimate at = made.start(12);
  EXPECT_TRUE(observed_wheels(*made.problem, at, Vector3d(0, 0, 0.1)));
  EXPECT_FALSE(observed_wheels(*made.problem, at, Vector3d(0, 0, 0.5)));
  Estimate slow = at;
  slow.nav.velocity *= 0.01;
  EXPECT_FALSE(observed_wheels(*made.problem, slow, Vector3d(0, 0, 0.1)));
}

}  // namespace
}  // namespace swath::trajectory
