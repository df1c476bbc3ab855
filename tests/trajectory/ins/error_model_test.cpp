// SPDX-License-Identifier: GPL-3.0-or-later
#include "trajectory/ins/error_model.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>

#include "core/geo/geodesy.h"
#include "tests/trajectory/ins_problem.h"
#include "tests/trajectory/ins_run.h"
#include "trajectory/ins/ins_smoother.h"
#include "trajectory/trajectory.h"

namespace swath::trajectory {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using test::InsProblem;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

InsProblem::Setup setup_of(double seconds, double spacing) {
  InsProblem::Setup s;
  s.sensors.until = seconds;
  s.fixes.velocity = true;
  s.options.error_spacing.value = spacing;
  return s;
}
test::MotionAt flight() { return test::motion_of(test::survey_flight(2)); }

/// A run about the trajectory of a first one, with what it was about.
struct Smoothing {
  std::vector<Estimate> reference;
  SmootherRun run;
  core::TrajectoryData data;

  explicit Smoothing(const InsProblem& made, size_t stretch = 20000) {
    for (const SmoothedNode& n : run_smoother(*made.problem, made.filter(), false).nodes) reference.push_back(n.estimate);
    run = run_smoother(*made.problem, made.filter(&reference), true, stretch);
    data.errors = run.errors;
    for (size_t k = 0; k < made.nodes.size(); ++k) {
      data.covariance.time.push_back(made.nodes[k].time);
      data.covariance.upper.push_back(run.nodes[k].covariance);
    }
  }
};

/// North, east, down, roll, pitch, heading that follow the first nine errors, by central differences.
MatrixXd pose_by_errors(const NavState& nav) {
  const core::Geodetic g = core::geodetic_of(nav.position);
  const Matrix3d ned = core::ecef_R_ned(g.latitude, g.longitude);
  MatrixXd by = MatrixXd::Zero(6, 9);
  by.block<3, 3>(0, 0) = ned.transpose();
  constexpr double h = 1e-6;
  for (int i = 0; i < 3; ++i) {
    const auto angles = [&](double size) {
      const core::Attitude a = core::attitude_of(ned.transpose() * core::exp_so3(size * Vector3d::Unit(i)) * nav.ecef_R_body);
      return Vector3d(a.roll, a.pitch, a.heading);
    };
    by.block<3, 1>(3, 6 + i) = (angles(h) - angles(-h)) / (2 * h);
  }
  return by;
}

/// The covariance of the errors of all nodes together: that of the motion without measurements, conditioned on one after the other.
MatrixXd dense(const InsProblem& made, const Smoothing& r) {
  const Layout& l = made.setup.layout;
  const Index n = l.size, nodes = static_cast<Index>(made.nodes.size());
  MatrixXd C = MatrixXd::Zero(nodes * n, nodes * n);
  MatrixXd P = made.covariance();
  for (Index k = 0; k < nodes; ++k) {
    const auto from = static_cast<size_t>(std::max<Index>(0, k - 1));
    Propagation way(l, r.reference[from]);
    ImuWalk walk(made.path, made.nodes[from].time);
    Increment piece;
    while (walk.next(made.nodes[static_cast<size_t>(k)].time, piece)) way.add(piece);
    const MatrixXd phi = way.transition(made.problem->noise);
    const VectorXd q = way.gained(made.problem->noise);
    P.diagonal() += q / 2;
    P = (phi * P * phi.transpose()).eval();
    P.diagonal() += q / 2;
    if (k > 0) C.middleRows(k * n, n).leftCols(k * n) = phi * C.middleRows((k - 1) * n, n).leftCols(k * n);
    C.block(k * n, k * n, n, n) = P;
  }
  C.triangularView<Eigen::StrictlyUpper>() = C.transpose();
  InsFilter filter = made.filter(&r.reference);
  for (Index k = 0; k < nodes; ++k) {
    NodeRecord record;
    filter.predict(static_cast<size_t>(k), &record);
    filter.update(static_cast<size_t>(k), &record, nullptr);
    for (const Update& u : record.updates) {
      const MatrixXd CHt = C.middleCols(k * n, n) * u.design.transpose();
      C -= CHt * u.weight * CHt.transpose();
    }
  }
  return C;
}

/// The six rows of each wanted node.
MatrixXd pose_of(const MatrixXd& C, const InsProblem& made, const Smoothing& r, const std::vector<size_t>& wanted) {
  const Index n = made.setup.layout.size, m = static_cast<Index>(wanted.size());
  MatrixXd by = MatrixXd::Zero(6 * m, C.cols());
  for (Index i = 0; i < m; ++i) {
    const size_t k = wanted[static_cast<size_t>(i)];
    by.block(6 * i, static_cast<Index>(k) * n, 6, 9) = pose_by_errors(r.run.nodes[k].estimate.nav);
  }
  return by * C * by.transpose();
}

void expect_near(const MatrixXd& a, const MatrixXd& b, double tolerance, const char* what) {
  ASSERT_EQ(a.rows(), b.rows());
  const VectorXd sigma = b.diagonal().cwiseSqrt().cwiseMax(1e-12);
  const MatrixXd apart = (sigma.cwiseInverse().asDiagonal() * (a - b) * sigma.cwiseInverse().asDiagonal()).cwiseAbs();
  EXPECT_LT(apart.maxCoeff(), tolerance) << what;
}

double least_eigenvalue(const MatrixXd& c) {
  const VectorXd s = c.diagonal().cwiseSqrt().cwiseInverse();
  return Eigen::SelfAdjointEigenSolver<MatrixXd>(s.asDiagonal() * c * s.asDiagonal(), Eigen::EigenvaluesOnly).eigenvalues().minCoeff();
}

constexpr double exact = 1e-6;  // of the product of two sigmas; inverses of the dense solution keep some nine digits

TEST(ErrorModel, IsTheDenseSolutionOfAllInstantsTogether) {
  for (const bool perfect : {false, true}) {
    // A perfect IMU has states without variance and without noise.
    InsProblem::Setup setup = setup_of(8, 1.0);
    if (perfect) setup.imu = {};
    const InsProblem made(flight(), setup);
    const Smoothing r(made);
    ASSERT_GE(made.nodes.size(), 40u);
    ASSERT_EQ(r.run.errors.size(), 9u);
    std::vector<size_t> at;
    for (size_t k = 0; k < made.nodes.size(); ++k)
      if (std::find(r.run.errors.time.begin(), r.run.errors.time.end(), made.nodes[k].time) != r.run.errors.time.end()) at.push_back(k);
    ASSERT_EQ(at.size(), 9u);
    EXPECT_EQ(at.front(), 0u);
    EXPECT_EQ(at.back(), made.nodes.size() - 1);
    const MatrixXd all = dense(made, r);
    const MatrixXd expected = pose_of(all, made, r, at);
    const ErrorModel model(r.data);
    EXPECT_TRUE(model.is_of_smoother());
    const MatrixXd found = model.covariance(r.run.errors.time);
    expect_near(found, expected, exact, perfect ? "perfect" : "tactical");
    // Far apart they still hang together: the fixes' correlated error, the lever arm.
    EXPECT_GT(std::abs(expected(0, 48)), 0.1 * std::sqrt(expected(0, 0) * expected(48, 48)));

    // Between links, at nodes: the interpolation against what is exact there.
    std::vector<size_t> between;
    std::vector<double> times;
    for (size_t k = 6; k + 3 < made.nodes.size(); k += 2) {
      between.push_back(k);
      times.push_back(made.nodes[k].time);
    }
    constexpr double interpolation = 0.02;  // of the product of two sigmas
    expect_near(model.covariance(times), pose_of(all, made, r, between), interpolation, "between links");
  }
}

TEST(ErrorModel, DependsNeitherOnSpacingNorOnStretch) {
  const InsProblem often(flight(), setup_of(20, 1.0)), seldom(flight(), setup_of(20, 4.0));
  const Smoothing a(often), b(seldom), parts(often, 7);
  ASSERT_EQ(b.run.errors.size(), 6u);
  expect_near(ErrorModel(a.data).covariance(b.run.errors.time), ErrorModel(b.data).covariance(b.run.errors.time), 1e-9, "spacing");
  EXPECT_EQ(a.run.errors.links, parts.run.errors.links);
  EXPECT_EQ(a.run.errors.rights, parts.run.errors.rights);
}

TEST(ErrorModel, IsSymmetricPositiveAndHasTheMarginals) {
  const InsProblem made(flight(), setup_of(20, 1.0));
  const Smoothing r(made);
  const ErrorModel model(r.data);
  const auto pose = [&](double t) {
    const auto c = r.data.covariance.at(t);
    Matrix6 out;
    out << c.topLeftCorner<3, 3>(), c.topRightCorner<3, 3>(), c.bottomLeftCorner<3, 3>(), c.bottomRightCorner<3, 3>();
    return out;
  };
  for (const double t : r.run.errors.time) expect_near(model.covariance({t}), pose(t), 1e-8, "marginal");
  test::Dice dice(5);
  std::vector<double> times;
  for (int i = 0; i < 60; ++i) times.push_back(test::motion_start + 20 * dice.uniform());
  times.push_back(times.front());         // twice the same
  times.push_back(times.front() + 1e-4);  // and nearly
  times.push_back(times.front() + 2e-4);
  const MatrixXd c = model.covariance(times);
  EXPECT_EQ(c, MatrixXd(c.transpose()));
  EXPECT_GT(least_eigenvalue(c), 1e-10);
  for (size_t i = 0; i < times.size(); ++i) {
    const Matrix6 block = c.block<6, 6>(6 * static_cast<Index>(i), 6 * static_cast<Index>(i));
    constexpr double between = 0.03;  // of sigma^2, where the first and last second bend most
    expect_near(block, pose(times[i]), between, "between");
  }
  // Any order: rows move with their instants. Outside: the first and the last.
  const MatrixXd turned = model.covariance({times[7], times[3]});
  const Eigen::Matrix<double, 6, 1> unit = c.diagonal().segment<6>(18).cwiseSqrt().cwiseInverse();
  EXPECT_LT((unit.asDiagonal() * (turned.block(0, 6, 6, 6) - c.block(42, 18, 6, 6)) * unit.asDiagonal()).cwiseAbs().maxCoeff(), 1e-9);
  const double first = r.run.errors.time.front(), last = r.run.errors.time.back();
  EXPECT_EQ(model.covariance({first - 5, last + 9}), model.covariance({first, last}));
  EXPECT_EQ(model.covariance({}).size(), 0);
}

/// Mean and slope of each of the six over one line, as rows on the stacked errors of its instants.
MatrixXd mean_and_slope(const std::vector<double>& t) {
  const double n = static_cast<double>(t.size());
  double mean = 0, squares = 0;
  for (const double v : t) mean += v / n;
  for (const double v : t) squares += (v - mean) * (v - mean);
  MatrixXd rows = MatrixXd::Zero(12, 6 * static_cast<Index>(t.size()));
  for (size_t k = 0; k < t.size(); ++k) {
    rows.block<6, 6>(0, 6 * static_cast<Index>(k)) = Matrix6::Identity() / n;
    rows.block<6, 6>(6, 6 * static_cast<Index>(k)) = Matrix6::Identity() * (t[k] - mean) / squares;
  }
  return rows;
}

TEST(ErrorModel, TellsTheErrorsOfLinesOverManySeeds) {
  constexpr int seeds = 40;
  constexpr double low = 0.85, high = 1.15;  // of the six components together, which 40 seeds tell to 5 %, of two lines to 3 %
  const test::Course& course = test::lines_and_turns();
  constexpr std::array<Span, 2> lines{{{10, 35}, {195, 220}}};
  Eigen::Matrix<double, 6, 5> squares = Eigen::Matrix<double, 6, 5>::Zero();
  for (int seed = 1; seed <= seeds; ++seed) {
    const InsGnssResult r = test::trial_of(core::ImuGrade::tactical, static_cast<std::uint64_t>(seed)).on(course);
    const core::TrajectoryData& d = r.trajectory;
    const ErrorModel model(d);
    ASSERT_TRUE(model.is_of_smoother());
    std::vector<double> at[2], all;
    std::vector<double> errors;
    for (size_t line = 0; line < 2; ++line)
      for (size_t k = 0; k < d.size(); k += 50) {
        if (d.time[k] < test::motion_start + lines[line].first || d.time[k] > test::motion_start + lines[line].last) continue;
        at[line].push_back(d.time[k]);
        all.push_back(d.time[k]);
        const test::Error6 e = test::error_of(d, k, course.motion);
        errors.insert(errors.end(), e.begin(), e.end());
      }
    const MatrixXd first = mean_and_slope(at[0]), second = mean_and_slope(at[1]);
    MatrixXd rows = MatrixXd::Zero(30, static_cast<Index>(errors.size()));
    rows.block(0, 0, 6, first.cols()) = first.topRows(6);
    rows.block(6, first.cols(), 6, second.cols()) = second.topRows(6);
    rows.block(12, 0, 6, first.cols()) = first.bottomRows(6);
    rows.block(18, first.cols(), 6, second.cols()) = second.bottomRows(6);
    rows.middleRows(24, 6) = rows.middleRows(6, 6) - rows.topRows(6);
    const VectorXd value = rows * Eigen::Map<const VectorXd>(errors.data(), rows.cols());
    const VectorXd variance = (rows * model.covariance(all) * rows.transpose()).diagonal();
    squares += value.cwiseAbs2().cwiseQuotient(variance).reshaped(6, 5) / seeds;
  }
  const auto expect_true = [&](const char* kind, const Eigen::Matrix<double, 6, 1>& square) {
    const Eigen::Matrix<double, 6, 1> ratio = square.cwiseSqrt();
    const double pooled = std::sqrt(square.mean());
    std::cout << kind << ": error / sigma " << ratio.transpose() << "; together " << pooled << "\n";
    EXPECT_GT(pooled, low) << kind;
    EXPECT_LT(pooled, high) << kind;
    // One component by itself: 40 seeds tell it to 11 %.
    EXPECT_GT(ratio.minCoeff(), 0.6) << kind;
    EXPECT_LT(ratio.maxCoeff(), 1.45) << kind;
  };
  expect_true("mean", 0.5 * (squares.col(0) + squares.col(1)));
  expect_true("slope", 0.5 * (squares.col(2) + squares.col(3)));
  expect_true("difference of means", squares.col(4));
}

TEST(ErrorModel, SurvivesAsPartOfTheTrajectory) {
  test::Trial trial = test::trial_of(core::ImuGrade::tactical);
  const test::Course& course = test::straight_line();
  const Trajectory kept(trial.on(course).trajectory);
  EXPECT_TRUE(ErrorModel(kept.data()).is_of_smoother());
  EXPECT_NEAR(kept.data().errors.time[1] - kept.data().errors.time[0], 1.0, 0.25);
  trial.options.error_spacing.value = 0;
  const InsGnssResult none = trial.on(course);
  EXPECT_TRUE(none.trajectory.errors.empty());
  EXPECT_FALSE(ErrorModel(none.trajectory).is_of_smoother());
  EXPECT_EQ(none.trajectory.latitude, kept.data().latitude);
}

/// Sigmas that grow from 1 to 3 over 10 s, times 1 to 6 by component.
core::TrajectoryData stated() {
  core::TrajectoryData d;
  for (int k = 0; k <= 10; ++k) d.time.push_back(test::motion_start + k);
  for (auto* c : {&d.latitude, &d.longitude, &d.height, &d.roll, &d.pitch, &d.heading}) c->assign(d.size(), 0.0);
  float factor = 1;
  for (auto* c : {&d.sigma_north, &d.sigma_east, &d.sigma_down, &d.sigma_roll, &d.sigma_pitch, &d.sigma_heading}) {
    for (size_t k = 0; k < d.size(); ++k) c->push_back(factor * (1 + 0.2F * static_cast<float>(k)));
    factor += 1;
  }
  return d;
}

TEST(ErrorModel, FallsBackToSigmasAndCorrelationTimes) {
  const core::TrajectoryData d = stated();
  ErrorModelOptions options;
  options.position_correlation.value = 10;
  options.roll_correlation.value = 5;
  options.pitch_correlation.value = 2.5;
  options.heading_correlation.value = 20;
  const ErrorModel model(d, options);
  EXPECT_FALSE(model.is_of_smoother());
  // 2.5 s: sigma 1.5; 7.5 s: 2.5; beyond the end: 3.
  const double t = test::motion_start;
  const MatrixXd c = model.covariance({t + 7.5, t + 2.5, t + 40});
  constexpr double rounding = 1e-6;  // sigmas are floats
  EXPECT_NEAR(c(0, 0), 2.5 * 2.5, rounding);
  EXPECT_NEAR(c(8, 8), 9 * 1.5 * 1.5, 9 * rounding);
  EXPECT_NEAR(c(17, 17), 36 * 9, 400 * rounding);
  EXPECT_NEAR(c(0, 6), 2.5 * 1.5 * std::exp(-0.5), 10 * rounding);
  EXPECT_NEAR(c(3, 9), 16 * 2.5 * 1.5 * std::exp(-1.0), 100 * rounding);
  EXPECT_NEAR(c(4, 10), 25 * 2.5 * 1.5 * std::exp(-2.0), 200 * rounding);
  EXPECT_NEAR(c(5, 11), 36 * 2.5 * 1.5 * std::exp(-0.25), 200 * rounding);
  EXPECT_EQ(c(0, 1), 0);
  EXPECT_EQ(c(0, 7), 0);

  // Nothing stated at all.
  core::TrajectoryData bare;
  bare.time = {t, t + 1};
  const MatrixXd b = ErrorModel(bare, options).covariance({t});
  EXPECT_NEAR(b(1, 1), std::pow(options.horizontal.value, 2), 1e-9);
  EXPECT_NEAR(b(2, 2), std::pow(options.vertical.value, 2), 1e-9);
  EXPECT_NEAR(b(4, 4), std::pow(options.roll_pitch.value, 2), 1e-15);
  EXPECT_NEAR(b(5, 5), std::pow(options.heading.value, 2), 1e-15);
}

TEST(ErrorModel, FallsBackToMarginalCovariances) {
  core::TrajectoryData d = stated();
  test::Dice dice(8);
  for (int k = 0; k < 3; ++k) {
    Eigen::Matrix<double, 9, 9> root;
    for (int i = 0; i < 81; ++i) root(i) = dice.normal();
    root.bottomRows<3>() *= 1e-5;
    d.covariance.time.push_back(test::motion_start + 5 * k);
    d.covariance.upper.push_back(core::CovarianceSeries::pack(root * root.transpose()));
  }
  const ErrorModel model(d);
  std::vector<double> times;
  for (int i = 0; i < 30; ++i) times.push_back(test::motion_start + 12 * dice.uniform() - 1);
  const MatrixXd c = model.covariance(times);
  EXPECT_EQ(c, MatrixXd(c.transpose()));
  EXPECT_GT(least_eigenvalue(c), 1e-10);
  for (size_t i = 0; i < times.size(); ++i) {
    const auto at = d.covariance.at(times[i]);
    Matrix6 marginal;
    marginal << at.topLeftCorner<3, 3>(), at.topRightCorner<3, 3>(), at.bottomLeftCorner<3, 3>(), at.bottomRightCorner<3, 3>();
    expect_near(c.block<6, 6>(6 * static_cast<Index>(i), 6 * static_cast<Index>(i)), marginal, 1e-8, "marginal");
  }
  // An hour apart nothing is left.
  EXPECT_LT(std::abs(model.covariance({test::motion_start, test::motion_start + 3600})(0, 6)), 1e-6);
}

}  // namespace
}  // namespace swath::trajectory
