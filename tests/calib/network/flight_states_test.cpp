// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/network/flight_states.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <set>
#include <vector>

namespace swath::calib {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

TEST(FlightStates, EachRowOfTheLayoutHasOnePlace) {
  for (const trajectory::Layout& l :
       {trajectory::Layout(), trajectory::Layout(true, true, true, true, true), trajectory::Layout(false, true, false, true, false),
        trajectory::Layout(true, false, true, false, true)}) {
    const FlightStates states(l, 3, 2);
    std::set<int> rows(states.moving().begin(), states.moving().end());
    rows.insert(states.constant().begin(), states.constant().end());
    EXPECT_EQ(rows.size(), static_cast<size_t>(l.size));
    EXPECT_EQ(states.moving().size() + states.constant().size(), static_cast<size_t>(l.size));
    const std::vector<int> pose{0, 1, 2, 6, 7, 8};
    EXPECT_TRUE(std::equal(pose.begin(), pose.end(), states.moving().begin()));
    const std::vector<int> sizes = states.sizes();
    ASSERT_EQ(sizes.size(), 7u);
    EXPECT_EQ(sizes[static_cast<size_t>(states.pose(2))], 6);
    EXPECT_EQ(sizes[static_cast<size_t>(states.motion(2))], static_cast<int>(states.moving().size()) - 6);
    EXPECT_EQ(sizes.back(), l.size - static_cast<int>(states.moving().size()) + 2);

    // An error put into the unknowns comes back in the layout's order.
    const NodeMatrix matrix(sizes);
    for (int node = 0; node < matrix.nodes(); ++node) EXPECT_EQ(states.first(node), matrix.first(node));
    VectorXd x = VectorXd::Zero(matrix.unknowns());
    for (Eigen::Index i = 0; i < x.size(); ++i) x[i] = static_cast<double>(i);
    const trajectory::StateVector e = states.at(1, x);
    for (size_t i = 0; i < states.moving().size(); ++i) EXPECT_EQ(e[states.moving()[i]], static_cast<double>(states.moving().size() + i));
    for (size_t i = 0; i < states.constant().size(); ++i)
      EXPECT_EQ(e[states.constant()[i]], static_cast<double>(3 * states.moving().size() + i));
  }
}

TEST(FlightStates, NormalsAreThoseOfTheDenseSystem) {
  const std::vector<int> sizes{2, 3, 1};
  NetworkNormals normals(sizes);
  MatrixXd dense = MatrixXd::Zero(6, 6);
  VectorXd right = VectorXd::Zero(6);
  double squares = 0;
  std::srand(3);
  for (int i = 0; i < 5; ++i) {
    const MatrixXd A = MatrixXd::Random(4, 6), root = MatrixXd::Random(4, 4), W = root * root.transpose();
    const VectorXd f = VectorXd::Random(4);
    std::vector<NetworkNormals::Part> parts;
    parts.emplace_back(0, A.leftCols(2));
    parts.emplace_back(1, A.middleCols(2, 3));
    parts.emplace_back(2, A.rightCols(1));
    if (i % 2) std::rotate(parts.begin(), parts.begin() + 2, parts.end());  // in any order of the nodes
    normals.add(parts, W, f);
    dense += A.transpose() * W * A;
    right += A.transpose() * W * f;
    squares += f.dot(W * f);
  }
  const NodeFactor factor(normals.N);
  const VectorXd x = factor.solve(normals.b);
  const VectorXd expected = dense.fullPivLu().solve(right);
  EXPECT_LT((x - expected).norm(), 1e-9 * expected.norm());
  EXPECT_NEAR(normals.squares, squares, 1e-12 * squares);
}

TEST(FlightStates, InformationOfVerySmallAndVeryLargeVariances) {
  MatrixXd C = MatrixXd::Zero(3, 3);
  C(0, 0) = 1e-24, C(1, 1) = 1.0, C(0, 1) = C(1, 0) = 2e-13;
  const MatrixXd W = information_of(C, VectorXd::Constant(3, 1e-30));
  MatrixXd floored = C;
  floored(2, 2) = 1e-30;
  const VectorXd s = floored.diagonal().cwiseSqrt();
  const MatrixXd one = s.cwiseInverse().asDiagonal() * floored * W * s.asDiagonal();
  EXPECT_LT((one - MatrixXd::Identity(3, 3)).cwiseAbs().maxCoeff(), 1e-9);
}

}  // namespace
}  // namespace swath::calib
