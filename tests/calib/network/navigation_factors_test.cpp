// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/network/navigation_factors.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>

#include "tests/calib/network/network_flight.h"

namespace swath::calib {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using test::NetworkFlight;

VectorXd right_of(const NetworkFlight& made, const std::vector<trajectory::Estimate>& at, double* squares = nullptr) {
  const FlightStates states(made.layout(), at.size());
  NetworkNormals normals(states.sizes());
  add_navigation(*made.flight.problem, states, at, {}, made.prior(), normals);
  if (squares) *squares = normals.squares;
  return normals.b;
}

/// Along any direction the squares fall by twice the right side: it is their derivative, every factor's Jacobian in it.
TEST(NavigationFactors, TheRightSideIsTheDerivativeOfTheSquares) {
  NetworkFlight made(6.0, true);
  const FlightStates states(made.layout(), made.reference.size());
  const VectorXd scale = [&] {
    NetworkNormals normals(states.sizes());
    add_navigation(*made.flight.problem, states, made.reference, {}, made.prior(), normals);
    return VectorXd(NodeFactor(normals.N).scale());
  }();
  const auto moved = [&](const VectorXd& x) {
    std::vector<trajectory::Estimate> at = made.reference;
    for (size_t k = 0; k < at.size(); ++k) at[k].correct(made.layout(), states.at(static_cast<int>(k), x));
    return at;
  };
  trajectory::test::Dice dice(11);
  for (int trial = 0; trial < 6; ++trial) {
    // Of each unknown a few of what its own observations can see, so that all kinds of residual take part.
    VectorXd away(scale.size()), direction(scale.size());
    for (Eigen::Index i = 0; i < scale.size(); ++i) {
      away[i] = 3 * scale[i] * dice.normal();
      direction[i] = scale[i] * dice.normal();
    }
    constexpr double h = 0.1;
    double plus = 0, minus = 0;
    right_of(made, moved(away + h * direction), &plus);
    right_of(made, moved(away - h * direction), &minus);
    const double slope = (plus - minus) / (2 * h), expected = -2 * right_of(made, moved(away)).dot(direction);
    EXPECT_NEAR(slope, expected, 2e-3 * std::abs(expected)) << trial;
  }
}

TEST(NavigationFactors, FixesThatTheSmootherWeighedDownAreWeighedDown) {
  NetworkFlight made(6.0, true);
  const FlightStates states(made.layout(), made.reference.size());
  std::vector<trajectory::FixOutcome> outcomes(made.reference.size());
  for (trajectory::FixOutcome& o : outcomes) o.innovation_sigma.setConstant(0.5);
  const auto variance = [&] {
    NetworkNormals normals(states.sizes());
    add_navigation(*made.flight.problem, states, made.reference, outcomes, made.prior(), normals);
    NodeFactor factor(normals.N);
    factor.invert();
    return factor.covariance({states.pose(states.instants() / 2)}).topLeftCorner<3, 3>().trace();
  };
  const double before = variance();
  for (trajectory::FixOutcome& o : outcomes) o.weight = 0.01;
  EXPECT_GT(variance(), 2 * before);
}

}  // namespace
}  // namespace swath::calib
