// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/network/network.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>

#include "tests/calib/network/network_flight.h"
#include "tests/trajectory/ins_run.h"

namespace swath::calib {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using test::NetworkFlight;

/// The largest departures of a network from a smoother, in the smoother's sigmas.
struct Departure {
  double state = 0, sigma = 0;
  void look(const trajectory::SmoothedNode& is, const trajectory::Estimate& estimate, const trajectory::StateVector& sigmas,
            const trajectory::Layout& l) {
    const trajectory::StateVector away = is.estimate.minus(estimate, l);
    for (int i = 0; i < l.size; ++i) {
      state = std::max(state, std::abs(away[i]) / sigmas[i]);
      sigma = std::max(sigma, std::abs(is.sigma[i] / sigmas[i] - 1));
    }
  }
};

TEST(Network, WithoutPlanesItIsTheSmoother) {
  for (const core::ImuGrade grade : {core::ImuGrade::navigation, core::ImuGrade::tactical, core::ImuGrade::mems}) {
    const NetworkFlight made(20.0, true, grade);
    Network network(*made.flight.problem, made.reference, made.run.outcomes, made.prior());
    network.solve();
    network.invert();
    const std::vector<trajectory::SmoothedNode> nodes = network.smoothed();
    Departure largest;
    for (size_t k = 0; k < nodes.size(); ++k) largest.look(nodes[k], made.run.nodes[k].estimate, made.run.nodes[k].sigma, made.layout());
    std::printf("grade %d: states within %.2g sigma, sigmas within %.2g\n", static_cast<int>(grade), largest.state, largest.sigma);
    EXPECT_LT(largest.state, 1e-3);
    EXPECT_LT(largest.sigma, 1e-4);
  }
}

TEST(Network, ASmallOneIsTheDenseSolution) {
  const NetworkFlight made(3.0, true);
  const FlightStates states(made.layout(), made.reference.size(), 2);
  NetworkNormals normals(states.sizes());
  add_navigation(*made.flight.problem, states, made.reference, {}, made.prior(), normals);
  // Two values of a calibration, seen together with some instants.
  for (const int k : {1, 5, 9}) {
    MatrixXd common = MatrixXd::Zero(2, normals.N.size(states.common()));
    common.rightCols(2) << 1, 0.5, -0.3 * k, 1;
    MatrixXd own = MatrixXd::Zero(2, FlightStates::pose_size);
    own.leftCols(2).setIdentity();
    normals.add({{states.pose(k), own}, {states.common(), common}}, 400 * MatrixXd::Identity(2, 2), Eigen::Vector2d(0.03, -0.02));
  }
  const NodeMatrix& N = normals.N;
  MatrixXd dense = MatrixXd::Zero(N.unknowns(), N.unknowns());
  for (int a = 0; a < N.nodes(); ++a)
    for (int b = 0; b <= a; ++b)
      if (const auto B = N.block(a, b); B.size() > 0) {
        dense.block(N.first(a), N.first(b), N.size(a), N.size(b)) = B;
        dense.block(N.first(b), N.first(a), N.size(b), N.size(a)) = B.transpose();
      }
  const VectorXd scale = dense.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::LDLT<MatrixXd> ldlt(scale.asDiagonal() * dense * scale.asDiagonal());
  const VectorXd expected = scale.asDiagonal() * ldlt.solve(scale.asDiagonal() * normals.b);
  const MatrixXd inverse = scale.asDiagonal() * ldlt.solve(MatrixXd(scale.asDiagonal()));
  NodeFactor factor(N);
  factor.invert();
  const VectorXd x = factor.solve(normals.b), sigma = inverse.diagonal().cwiseSqrt();
  // Both round: the information of 0.25 s of IMU is 1e7 times that of the whole flight. Seen: 6e-8.
  constexpr double same = 1e-6;
  EXPECT_LT((x - expected).cwiseQuotient(sigma).cwiseAbs().maxCoeff(), same);
  double apart = 0;
  for (int k = 0; k + 1 < states.instants(); ++k) {
    const std::vector<int> nodes{states.pose(k), states.motion(k), states.pose(k + 1), states.motion(k + 1), states.common()};
    const MatrixXd C = factor.covariance(nodes);
    std::vector<int> rows;
    for (const int node : nodes)
      for (int i = 0; i < N.size(node); ++i) rows.push_back(N.first(node) + i);
    const VectorXd s = sigma(rows).cwiseInverse();
    apart = std::max(apart, (s.asDiagonal() * (C - inverse(rows, rows)) * s.asDiagonal()).cwiseAbs().maxCoeff());
  }
  EXPECT_LT(apart, same);
  std::printf("x within %.2g sigma, covariances within %.2g\n", (x - expected).cwiseQuotient(sigma).cwiseAbs().maxCoeff(), apart);
}

/// A whole flight as the stage has it: records in, a smoother that estimates shares and weights, and the network from what it leaves.
TEST(Network, AWholeFlightAgreesWithTheSmoother) {
  for (const core::ImuGrade grade : {core::ImuGrade::tactical, core::ImuGrade::mems}) {
    const trajectory::test::Trial trial = trajectory::test::trial_of(grade);
    const trajectory::test::Course& course = trajectory::test::lines_and_turns();
    trajectory::SmoothedFlight flight;
    const trajectory::InsGnssResult smoothed = smooth(swath::test::with_errors(course.exact.imu, core::error_model_of(grade), trial.seed),
                                                      swath::test::with_errors(course.exact.gnss, trial.fixes, trial.seed), trial.stated,
                                                      course.sensors.lever, trial.lever_sigma, trial.options, {}, core::unwatched, &flight);
    const trajectory::Problem problem = flight.problem();
    Network network(problem, flight.estimates, flight.outcomes, prior_of(flight));
    network.solve();
    network.invert();
    const std::vector<trajectory::SmoothedNode> nodes = network.smoothed();
    ASSERT_EQ(nodes.size(), smoothed.trajectory.covariance.time.size());
    double state = 0, sigma = 0;
    for (size_t k = 0; k < nodes.size(); ++k) {
      const auto is = core::CovarianceSeries::unpack(nodes[k].covariance),
                 was = smoothed.trajectory.covariance.unpack(smoothed.trajectory.covariance.upper[k]);
      for (int i = 0; i < 9; ++i) sigma = std::max(sigma, std::abs(std::sqrt(is(i, i) / was(i, i)) - 1));
      const trajectory::StateVector away = nodes[k].estimate.minus(flight.estimates[k], flight.layout);
      for (int i = 0; i < 15; ++i) state = std::max(state, std::abs(away[i]) / nodes[k].sigma[i]);
    }
    std::printf("grade %d, %zu instants: states within %.2g sigma, sigmas within %.2g\n", static_cast<int>(grade), nodes.size(), state,
                sigma);
    EXPECT_LT(state, 0.01);
    EXPECT_LT(sigma, 0.01);
  }
}

}  // namespace
}  // namespace swath::calib
