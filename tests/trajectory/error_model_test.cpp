// SPDX-License-Identifier: GPL-3.0-or-later
#include "trajectory/error_model.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>

#include "core/geodesy.h"
#include "tests/trajectory/ins_problem.h"
#include "tests/trajectory/ins_run.h"
#include "trajectory/ins_smoother.h"
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
struct Run {
  std::vector<Estimate> reference;
  SmootherRun run;
  core::TrajectoryData data;

  explicit Run(const InsProblem& made, size_t stretch = 20000) {
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
MatrixXd dense(const InsProblem& made, const Run& r) {
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
MatrixXd pose_of(const MatrixXd& C, const InsProblem& made, const Run& r, const std::vector<size_t>& wanted) {
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
    const Run r(made);
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
  const Run a(often), b(seldom), parts(often, 7);
  ASSERT_EQ(b.run.errors.size(), 6u);
  expect_near(ErrorModel(a.data).covariance(b.run.errors.time), ErrorModel(b.data).covariance(b.run.errors.time), 1e-9, "spacing");
  EXPECT_EQ(a.run.errors.links, parts.run.errors.links);
  EXPECT_EQ(a.run.errors.rights, parts.run.errors.rights);
}

TEST(ErrorModel, IsSymmetricPositiveAndHasTheMarginals) {
  const InsProblem made(flight(), setup_of(20, 1.0));
  const Run r(made);
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
  times.push_back(times.front());                    // twice the same
  times.push_back(times.front() + 1e-4);             // and nearly
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
  EXPECT_EQ(turned.block(0, 6, 6, 6), c.block(42, 18, 6, 6));
  const double first = r.run.errors.time.front(), last = r.run.errors.time.back();
  EXPECT_EQ(model.covariance({first - 5, last + 9}), model.covariance({first, last}));
  EXPECT_EQ(model.covariance({}).size(), 0);
}

/// Means over two lines, their difference, slopes within: what a calibration sees of the errors.
struct Lines {
  VectorXd value;      // of errors
  MatrixXd functional;  // rows: 6 components each of mean 1, mean 2, difference, slope 1, slope 2
  static constexpr int kinds = 5;

  static MatrixXd functional_of(const std::vector<double>& a, const std::vector<double>& b) {
    const auto n = static_cast<Index>(a.size()), m = static_cast<Index>(b.size());
    MatrixXd f = MatrixXd::Zero(6 * kinds, 6 * (n + m));
    const auto fill = [&](int kind, Index first, const std::vector<double>& t, bool slope, double sign) {
      double mean = 0, squares = 0;
      for (const double v : t) mean += v / static_cast<double>(t.size());
      for (const double v : t) squares += (v - mean) * (v - mean);
      for (size_t k = 0; k < t.size(); ++k)
        for (Index i = 0; i < 6; ++i)
          f(6 * kind + i, 6 * (first + static_cast<Index>(k)) + i) += sign * (slope ? (t[k] - mean) / squares : 1 / static_cast<double>(t.size()));
    };
    fill(0, 0, a, false, 1), fill(1, n, b, false, 1), fill(2, 0, a, false, -1), fill(2, n, b, false, 1), fill(3, 0, a, true, 1), fill(4, n, b, true, 1);
    return f;
  }
};

TEST(ErrorModel, TellsTheErrorsOfLinesOverManySeeds) {
  constexpr int seeds = 24;
  constexpr double low = 0.85, high = 1.15;  // of all components together: 24 seeds x 6 components tell them to some 5 %
  const test::Course& course = test::lines_and_turns();
  MatrixXd squares = MatrixXd::Zero(6, Lines::kinds);
  for (int seed = 1; seed <= seeds; ++seed) {
    const InsGnssResult r = test::trial_of(core::ImuGrade::tactical, static_cast<std::uint64_t>(seed)).on(course);
    const core::TrajectoryData& d = r.trajectory;
    const ErrorModel model(d);
    ASSERT_TRUE(model.is_of_smoother());
    std::vector<double> a, b, all;
    std::vector<Vector3d> dummy;
    VectorXd errors;
    std::vector<test::Error6> seen;
    const auto collect = [&](double from, double until, std::vector<double>& into) {
      for (size_t k = 0; k < d.size(); k += 50) {
        if (d.time[k] < test::motion_start + from || d.time[k] > test::motion_start + until) continue;
        into.push_back(d.time[k]);
        seen.push_back(test::error_of(d, k, course.motion));
      }
    };
    collect(20, 45, a);
    collect(195, 220, b);
    errors.resize(6 * static_cast<Index>(seen.size()));
    for (size_t k = 0; k < seen.size(); ++k) errors.segment<6>(6 * static_cast<Index>(k)) = seen[k];
    all = a;
    all.insert(all.end(), b.begin(), b.end());
    const MatrixXd f = Lines::functional_of(a, b);
    const VectorXd value = f * errors, sigma = (f * model.covariance(all) * f.transpose()).diagonal().cwiseSqrt();
    squares += value.cwiseQuotient(sigma).cwiseAbs2().reshaped(6, Lines::kinds) / seeds;
  }
  const MatrixXd ratio = squares.cwiseSqrt();
  std::cout << "error / sigma, rows north to heading, columns mean, mean, difference, slope, slope\n" << ratio << "\n";
  for (int kind = 0; kind < Lines::kinds; ++kind) {
    const double pooled = std::sqrt(squares.col(kind).mean());
    EXPECT_GT(pooled, low) << kind;
    EXPECT_LT(pooled, high) << kind;
  }
  EXPECT_LT(ratio.maxCoeff(), 1.6);
  EXPECT_GT(ratio.minCoeff(), 0.5);
}

}  // namespace
}  // namespace swath::trajectory
