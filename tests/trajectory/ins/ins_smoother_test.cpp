// SPDX-License-Identifier: GPL-3.0-or-later
#include "trajectory/ins/ins_smoother.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "core/geo/geodesy.h"
#include "tests/trajectory/ins_problem.h"

namespace swath::trajectory {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using test::InsProblem;
using Matrix9 = core::CovarianceSeries::Matrix9;

test::MotionAt flight() { return test::motion_of(test::survey_flight(2)); }

std::vector<Estimate> estimates(const SmootherRun& run) {
  std::vector<Estimate> out;
  for (const SmoothedNode& n : run.nodes) out.push_back(n.estimate);
  return out;
}

/// Rauch, Tung and Striebel by the book, in dense matrices with inverses, from what the filter leaves.
struct Textbook {
  std::vector<Eigen::VectorXd> mean;
  std::vector<Eigen::MatrixXd> covariance;

  Textbook(const InsProblem& made, const std::vector<Estimate>& reference) {
    const Layout& l = made.setup.layout;
    const size_t n = made.nodes.size();
    std::vector<Eigen::MatrixXd> phi(n), before(n), after(n);
    std::vector<Eigen::VectorXd> mean_before(n), mean_after(n);
    InsFilter filter = made.filter(&reference);
    Eigen::MatrixXd P = made.covariance();
    Eigen::VectorXd x;
    for (size_t k = 0; k < n; ++k) {
      // The transition and noise over the interval before, not by the filter.
      const size_t from = k > 0 ? k - 1 : 0;
      Propagation way(l, reference[from]);
      ImuWalk walk(made.path, made.nodes[from].time);
      Increment piece;
      while (walk.next(made.nodes[k].time, piece)) way.add(piece);
      phi[k] = way.transition(made.problem->noise);
      const Eigen::VectorXd q = way.gained(made.problem->noise);
      P.diagonal() += q / 2;
      P = (phi[k] * P * phi[k].transpose()).eval();
      P.diagonal() += q / 2;
      before[k] = P;
      NodeRecord record;
      filter.predict(k, &record);
      Estimate pushed = reference[from];
      pushed.nav = way.nav();
      pushed.fix *= std::exp(-std::abs(way.elapsed()) / made.problem->noise.fix_time);
      x = (k == 0 ? Eigen::VectorXd(made.start().minus(reference[0], l)) : Eigen::VectorXd(phi[k] * x + pushed.minus(reference[k], l)));
      mean_before[k] = x;
      filter.update(k, &record, nullptr);
      for (const Update& u : record.updates) {
        const Eigen::MatrixXd gain = P * u.design.transpose() * u.weight;
        x += gain * u.innovation;
        P = (P - gain * u.design * P).eval();
        P = (0.5 * (P + P.transpose())).eval();
      }
      after[k] = P;
      mean_after[k] = x;
    }
    mean = mean_after;
    covariance = after;
    for (size_t k = n - 1; k-- > 0;) {
      const Eigen::VectorXd s = before[k + 1].diagonal().cwiseSqrt().cwiseInverse();
      const Eigen::MatrixXd scaled = s.asDiagonal() * before[k + 1] * s.asDiagonal();
      const Eigen::MatrixXd inverse = s.asDiagonal() * scaled.ldlt().solve(Eigen::MatrixXd(s.asDiagonal()));
      const Eigen::MatrixXd gain = after[k] * phi[k + 1].transpose() * inverse;
      mean[k] = mean_after[k] + gain * (mean[k + 1] - mean_before[k + 1]);
      covariance[k] = after[k] + gain * (covariance[k + 1] - before[k + 1]) * gain.transpose();
    }
  }
};

TEST(InsSmoother, IsRauchTungAndStriebels) {
  InsProblem::Setup setup;
  setup.fixes.velocity = true;
  const InsProblem made(flight(), setup);
  const std::vector<Estimate> reference = estimates(run_smoother(*made.problem, made.filter()));
  const SmootherRun run = run_smoother(*made.problem, made.filter(&reference));
  const Textbook book(made, reference);
  constexpr double relative = 1e-6;
  for (size_t k = 0; k < made.nodes.size(); ++k) {
    const SmoothedNode& node = run.nodes[k];
    const StateVector mean = node.estimate.minus(reference[k], made.setup.layout);
    const Eigen::VectorXd sigma = book.covariance[k].diagonal().cwiseSqrt();
    for (int i = 0; i < made.setup.layout.size; ++i) {
      ASSERT_NEAR(node.sigma[i], sigma[i], relative * sigma[i]) << "node " << k << ", state " << i;
      ASSERT_NEAR(mean[i], book.mean[k][i], relative * sigma[i]) << "node " << k << ", state " << i;
    }
    const Matrix9 local = core::CovarianceSeries::unpack(node.covariance);
    const Matrix9 expected = local_covariance(node.estimate.nav, book.covariance[k].topLeftCorner<9, 9>());
    for (int i = 0; i < 9; ++i)
      for (int j = 0; j < 9; ++j)
        ASSERT_NEAR(local(i, j), expected(i, j), 2 * relative * std::sqrt(expected(i, i) * expected(j, j))) << k << " " << i << " " << j;
  }
}

TEST(InsSmoother, DoesNotDependOnTheStretch) {
  InsProblem::Setup setup;
  setup.change_gnss = [](core::GnssData g) {
    g.position[40] += Vector3d(2, 2, 2);
    return test::without(g, 10, 14);
  };
  const InsProblem made(flight(), setup);
  ASSERT_GT(made.nodes.size(), 90u);
  const SmootherRun whole = run_smoother(*made.problem, made.filter());
  for (const size_t stretch : {size_t{50}, size_t{7}, made.nodes.size(), made.nodes.size() - 1}) {
    const SmootherRun parts = run_smoother(*made.problem, made.filter(), true, stretch);
    for (size_t k = 0; k < made.nodes.size(); ++k) {
      ASSERT_EQ(parts.nodes[k].estimate.nav.position, whole.nodes[k].estimate.nav.position) << stretch << " " << k;
      ASSERT_EQ(parts.nodes[k].estimate.nav.ecef_R_body, whole.nodes[k].estimate.nav.ecef_R_body);
      ASSERT_EQ(parts.nodes[k].covariance, whole.nodes[k].covariance);
      ASSERT_EQ(parts.nodes[k].sigma, whole.nodes[k].sigma);
      ASSERT_EQ(parts.forward[k].position, whole.forward[k].position);
      ASSERT_EQ(parts.outcomes[k].weight, whole.outcomes[k].weight);
    }
  }
  // Without covariances: the same estimates, sigmas at the ends.
  const SmootherRun bare = run_smoother(*made.problem, made.filter(), false, 50);
  for (size_t k = 0; k < made.nodes.size(); ++k) {
    const bool end = k == 0 || k + 1 == made.nodes.size();
    ASSERT_EQ(bare.nodes[k].estimate.nav.position, whole.nodes[k].estimate.nav.position);
    ASSERT_EQ(bare.nodes[k].sigma.size() > 0, end) << k;
  }
}

TEST(InsSmoother, IsBetterThanEitherFilterAndTrue) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    InsProblem::Setup setup;
    setup.seed = seed;
    const InsProblem made(flight(), setup);
    const SmootherRun run = run_smoother(*made.problem, made.filter());
    const InsFilter last(*made.problem, run.nodes.back().estimate, StateVector::Zero(made.setup.layout.size), made.covariance(), nullptr);
    const std::vector<FilterNode> backward = run_backward(*made.problem, last);
    double separation = 0, n = 0;
    for (size_t k = 0; k < made.nodes.size(); ++k) {
      const double smoothed = run.nodes[k].sigma.head<3>().norm();
      EXPECT_LE(smoothed, 1.0001 * std::sqrt(run.forward[k].position_covariance.trace()));
      EXPECT_LE(smoothed, 1.0001 * std::sqrt(backward[k].position_covariance.trace()));
      if (made.nodes[k].time < test::motion_start + 2 || made.nodes[k].time > test::motion_start + 18) continue;
      const Vector3d apart = run.forward[k].position - backward[k].position;
      separation += apart.dot((run.forward[k].position_covariance + backward[k].position_covariance).llt().solve(apart)) / 3;
      ++n;
      const Eigen::Matrix<double, 9, 1> e = made.error_of(run.nodes[k].estimate);
      EXPECT_LT(e.cwiseQuotient(run.nodes[k].sigma.head<9>()).cwiseAbs().maxCoeff(), 4.5) << seed << " " << k;
    }
    // Both passes share the correlated part of the fixes, the lever arm and the latency, so that they lie closer than their sigmas say.
    EXPECT_LT(separation / n, 1.0) << seed;
    EXPECT_GT(separation / n, 0.02) << seed;
  }
}

TEST(InsSmoother, LocalCovarianceFollowsFiniteRotations) {
  test::Dice dice(3);
  for (const double pitch : {0.0, 0.1, -0.7}) {
    NavState nav;
    nav.position = core::ecef_of({0.8, -1.9, 500.0});
    const Matrix3d ned = core::ecef_R_ned(0.8, -1.9);
    nav.ecef_R_body = ned * core::matrix_of({0.3, pitch, 5.1});
    Eigen::Matrix<double, 9, 9> root;
    for (int i = 0; i < 81; ++i) root(i) = dice.normal();
    const Matrix9 ecef = root * root.transpose();
    // Position, velocity and angles that follow each error, by central differences.
    Matrix9 by = Matrix9::Zero();
    by.block<3, 3>(0, 0) = by.block<3, 3>(3, 3) = ned.transpose();
    constexpr double h = 1e-6;
    for (int i = 0; i < 3; ++i) {
      const auto angles = [&](double size) {
        const core::Attitude a = core::attitude_of(ned.transpose() * core::exp_so3(size * Vector3d::Unit(i)) * nav.ecef_R_body);
        return Vector3d(a.roll, a.pitch, a.heading);
      };
      by.block<3, 1>(6, 6 + i) = (angles(h) - angles(-h)) / (2 * h);
    }
    const Matrix9 expected = by * ecef * by.transpose(), local = local_covariance(nav, ecef);
    EXPECT_LT((local - expected).norm(), 1e-8 * expected.norm()) << pitch;
  }
}

}  // namespace
}  // namespace swath::trajectory
