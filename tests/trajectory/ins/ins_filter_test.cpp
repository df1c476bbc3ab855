// SPDX-License-Identifier: GPL-3.0-or-later
#include "trajectory/ins/ins_filter.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "core/geo/geodesy.h"
#include "tests/trajectory/ins_problem.h"

namespace swath::trajectory {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using test::InsProblem;

test::MotionAt flight() { return test::motion_of(test::survey_flight(2)); }

/// Symmetric to the last bit, and its correlations have no eigenvalue below zero beyond rounding.
void expect_covariance(const StateMatrix& P, size_t node) {
  ASSERT_EQ((P - P.transpose()).cwiseAbs().maxCoeff(), 0.0) << node;
  const StateVector s = P.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  ASSERT_GE(P.diagonal().minCoeff(), 0.0) << node;
  const StateMatrix correlation = s.asDiagonal() * P * s.asDiagonal();
  constexpr double rounding = 1e-9;
  ASSERT_GT(Eigen::SelfAdjointEigenSolver<StateMatrix>(correlation).eigenvalues().minCoeff(), -rounding) << node;
}

TEST(InsFilter, CovarianceStaysOne) {
  // Fixes of a tenth of a millimetre beside a start of half a metre: the harshest updates that a survey could bring.
  InsProblem::Setup setup;
  setup.fixes = {.horizontal = 1e-4, .vertical = 1e-4, .velocity = true};
  const InsProblem made(flight(), setup);
  InsFilter f = made.filter();
  for (size_t k = 0; k < made.nodes.size(); ++k) {
    f.predict(k, nullptr);
    f.update(k, nullptr, nullptr);
    expect_covariance(f.covariance(), k);
  }
}

TEST(InsFilter, IsWithinItsSigmasOnwardAndBack) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    InsProblem::Setup setup;
    setup.seed = seed;
    const InsProblem made(flight(), setup);
    InsFilter onward = made.filter();
    double squares = 0;
    for (size_t k = 0; k < made.nodes.size(); ++k) {
      onward.predict(k, nullptr);
      onward.update(k, nullptr, nullptr);
      EXPECT_NEAR(onward.estimate().nav.time, made.nodes[k].time, 1e-6);
    }
    const auto normed = [&](const InsFilter& f) {
      const Eigen::Matrix<double, 9, 1> e = made.error_of(f.estimate());
      return e.dot(f.covariance().topLeftCorner<9, 9>().llt().solve(e));
    };
    squares = normed(onward);
    // Chi-square of 9 degrees of freedom: below 30 with a probability of 0.9996.
    EXPECT_LT(squares, 30.0) << seed;
    InsFilter back(*made.problem, made.start(made.nodes.size() - 1), StateVector::Zero(made.setup.layout.size), made.covariance(), nullptr);
    for (size_t k = made.nodes.size(); k-- > 0;) {
      back.predict(k, nullptr);
      back.update(k, nullptr, nullptr);
    }
    EXPECT_LT(normed(back), 30.0) << seed << ", backward";
    EXPECT_NEAR(back.estimate().nav.time, made.nodes.front().time, 1e-6);
    // A latency of 5 ms, which is not known yet, is 0.25 m along the track.
    EXPECT_LT(back.covariance()(0, 0), 0.1 * made.covariance()(0, 0));
  }
}

TEST(InsFilter, AReferenceChangesTheLinearisationAlone) {
  const InsProblem made(flight(), {});
  std::vector<Estimate> own(made.nodes.size());
  InsFilter first = made.filter();
  for (size_t k = 0; k < made.nodes.size(); ++k) {
    first.predict(k, nullptr);
    first.update(k, nullptr, nullptr);
    own[k] = first.estimate();
  }
  // About the truth: the same estimate but for terms of second order of the start's errors.
  std::vector<Estimate> truth(made.nodes.size());
  for (size_t k = 0; k < made.nodes.size(); ++k) {
    truth[k].nav = test::nav_at(made.motion, made.nodes[k].time - test::motion_start);
    truth[k].lever = made.setup.sensors.lever;
  }
  InsFilter second = made.filter(&truth);
  for (size_t k = 0; k < made.nodes.size(); ++k) {
    second.predict(k, nullptr);
    second.update(k, nullptr, nullptr);
  }
  const StateVector change = second.estimate().minus(own.back(), made.setup.layout);
  for (int i = 0; i < 9; ++i) EXPECT_LT(std::abs(change[i]), 0.25 * std::sqrt(second.covariance()(i, i))) << i;
  for (int i = 0; i < 9; ++i) EXPECT_NEAR(std::sqrt(second.covariance()(i, i) / first.covariance()(i, i)), 1.0, 0.02) << i;
}

TEST(InsFilter, OutcomeOfAFixIsWhatItSays) {
  const InsProblem made(flight(), {});
  InsFilter f = made.filter();
  NodeRecord record;
  FixOutcome outcome;
  f.predict(0, &record);
  const Estimate before = f.estimate();
  const StateMatrix P = f.covariance();
  f.update(0, &record, &outcome);
  ASSERT_EQ(record.updates.size(), 1u);
  const Update& u = record.updates[0];
  const core::Geodetic g = core::geodetic_of(made.gnss.position[0]);
  const Matrix3d ned = core::ecef_R_ned(g.latitude, g.longitude);
  const Vector3d antenna = before.nav.position + before.nav.ecef_R_body * before.lever;
  EXPECT_LT((outcome.innovation - ned.transpose() * (made.gnss.position[0] - antenna)).norm(), 1e-8);
  // S of all: H P H' + R, where the correlated part is a state.
  const Matrix3d S = u.design * P * u.design.transpose() + 0.6 * made.gnss.covariance[0];
  EXPECT_LT((u.weight * S - Matrix3d::Identity()).norm(), 1e-9);
  EXPECT_LT((u.gain - P * u.design.transpose() * u.weight).norm(), 1e-9);
  EXPECT_NEAR(outcome.nis, u.innovation.dot(S.inverse() * u.innovation), 1e-9);
  EXPECT_LT(((ned.transpose() * S * ned).diagonal().cwiseSqrt() - outcome.innovation_sigma).norm(), 1e-9);
  EXPECT_EQ(outcome.weight, 1.0);
  EXPECT_EQ(outcome.velocity_nis, -1.0);
}

TEST(InsFilter, AnOutlierIsKeptOnTheGate) {
  InsProblem::Setup setup;
  setup.change_gnss = [](core::GnssData g) {
    g.position[50] += Vector3d(3, -2, 1);
    return g;
  };
  const InsProblem made(flight(), setup);
  InsFilter f = made.filter();
  size_t seen = 0;
  for (size_t k = 0; k < made.nodes.size(); ++k) {
    NodeRecord record;
    FixOutcome outcome;
    f.predict(k, &record);
    const StateMatrix before = f.covariance();
    f.update(k, &record, &outcome);
    if (made.nodes[k].fix < 0) continue;
    if (made.nodes[k].fix != 50) {
      EXPECT_EQ(outcome.weight, 1.0) << made.nodes[k].fix;
      continue;
    }
    ++seen;
    EXPECT_GT(outcome.nis, 1000.0);
    EXPECT_NEAR(outcome.weight, made.problem->gate / outcome.nis, 1e-12);
    const Update& u = record.updates.at(0);
    EXPECT_NEAR(u.innovation.dot(u.weight * u.innovation), made.problem->gate, 1e-6 * made.problem->gate);
    // The gain is the best one for the larger noise: then P - K H P is Joseph's form.
    const StateMatrix expected = before - u.gain * u.design * before;
    for (int i = 0; i < expected.rows(); ++i) EXPECT_NEAR(f.covariance()(i, i) / expected(i, i), 1.0, 1e-6) << i;
  }
  EXPECT_EQ(seen, 1u);
  const Eigen::Matrix<double, 9, 1> e = made.error_of(f.estimate());
  EXPECT_LT(e.dot((f.covariance().topLeftCorner<9, 9>()).llt().solve(e)), 30.0);
}

TEST(InsFilter, VelocitiesAreUsedWhereThereAreSome) {
  InsProblem::Setup setup;
  setup.fixes.velocity = true;
  setup.change_gnss = [](core::GnssData g) {
    for (size_t k = 0; k < g.size(); k += 2) g.velocity[k].setConstant(std::nan(""));
    return g;
  };
  const InsProblem made(flight(), setup);
  InsFilter f = made.filter();
  double nis = 0, n = 0;
  for (size_t k = 0; k < made.nodes.size(); ++k) {
    NodeRecord record;
    FixOutcome outcome;
    f.predict(k, &record);
    f.update(k, &record, &outcome);
    if (made.nodes[k].fix < 0) continue;
    const bool has = made.nodes[k].fix % 2 == 1;
    EXPECT_EQ(record.updates.size(), has ? 2u : 1u);
    if (has) {
      nis += outcome.velocity_nis;
      ++n;
    } else {
      EXPECT_EQ(outcome.velocity_nis, -1.0);
    }
  }
  // Mean of n chi-squares of 3: sigma sqrt(6 / n) = 0.35; the lag of the rate adds to it.
  EXPECT_NEAR(nis / n, 3.0, 1.2);
  setup.options.use_velocity = false;
  const InsProblem silent(flight(), setup);
  InsFilter g = silent.filter();
  NodeRecord record;
  g.predict(1, &record);
  g.update(1, &record, nullptr);
  EXPECT_LE(record.updates.size(), 1u);
}

TEST(InsFilter, StandstillAndWheels) {
  // Stands for 10 s, drives on; no fixes: what is known of the velocity comes from the ground alone.
  InsProblem::Setup setup;
  setup.sensors.until = 40;
  setup.layout = Layout(true, true, true, false, true);
  setup.still_until = 10.0;
  setup.options.non_holonomic = true;
  setup.change_gnss = [](const core::GnssData& g) { return test::keep_fixes(g, [](size_t k) { return k % 100 == 0; }); };
  const InsProblem made(test::Drive({{10, 1}}), setup);
  InsFilter f = made.filter();
  size_t still = 0, wheels = 0, early = 0;
  for (size_t k = 0; k < made.nodes.size(); ++k) {
    NodeRecord record;
    f.predict(k, &record);
    f.update(k, &record, nullptr);
    const double t = made.nodes[k].time - test::motion_start;
    for (const Update& u : record.updates) {
      if (u.design.rows() == 2) {
        ++wheels;
        early += made.motion(t).velocity.norm() < 1.5;
      } else if (u.design.rows() == 3 && u.design(0, Layout::position) == 0.0) {
        ++still;
      }
    }
    if (t > 9.0 && t < 10.0) {
      EXPECT_LT(f.estimate().nav.velocity.norm(), 0.05) << t;
      EXPECT_LT(std::sqrt(f.covariance()(3, 3)), 0.03) << t;
    }
  }
  // Nodes lie 0.25 s apart.
  EXPECT_NEAR(static_cast<double>(still), 40.0, 2.0);
  EXPECT_NEAR(static_cast<double>(wheels), 110.0, 10.0);
  EXPECT_EQ(early, 0u);
  // Across and down the velocity is known as the wheels know it.
  const Vector3d v = f.estimate().nav.ecef_R_body.transpose() * made.error_of(f.estimate()).segment<3>(3);
  EXPECT_LT(std::abs(v.y()), 0.3);
  EXPECT_LT(std::abs(v.z()), 0.3);
}

TEST(InsFilter, AStandstillThatTheFixesDenyIsNotBelieved) {
  InsProblem::Setup setup;
  setup.still_until = 40.0;  // of a car that drives from 6 s on
  setup.sensors.until = 20;
  const InsProblem made(test::Drive({{0, 0.3}}), setup);
  InsFilter f = made.filter();
  double worst = 0;
  for (size_t k = 0; k < made.nodes.size(); ++k) {
    f.predict(k, nullptr);
    f.update(k, nullptr, nullptr);
    if (made.nodes[k].time > test::motion_start + 10) worst = std::max(worst, made.error_of(f.estimate()).segment<3>(3).norm());
  }
  EXPECT_LT(worst, 1.0) << "of some 5 m/s";
}

}  // namespace
}  // namespace swath::trajectory
