// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/adjust/tie_matrix.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "tests/world/navigation.h"

namespace swath::calib {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Unknowns of a node need not be neighbours.
const std::vector<int> some_nodes = {0, 2, 1, 1, 2, 3, 1, 3, 0, 2};

MatrixXd symmetric(int n, swath::test::Dice& dice) {
  MatrixXd A(n, n);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) A(i, j) = dice.normal();
  return A * A.transpose() + 0.1 * MatrixXd::Identity(n, n);
}

struct Made {
  explicit Made(const std::vector<int>& nodes) : N(std::make_shared<UnknownNodes>(nodes)) {
    swath::test::Dice dice(4);
    const auto n = static_cast<Eigen::Index>(nodes.size());
    whole = MatrixXd::Zero(n, n);
    for (const std::vector<int>& numbers : {std::vector<int>{1, 4, 9, 2, 3, 6}, {8, 0, 3}, {5, 7, 2}, {6, 2}}) {
      const MatrixXd M = symmetric(static_cast<int>(numbers.size()), dice);
      N.add(numbers, M, 2.0);
      whole(numbers, numbers) += 2.0 * M;
    }
  }
  TieMatrix N;
  MatrixXd whole;
};

TEST(TieMatrix, IsTheSameByNodesAndAsOne) {
  for (const std::vector<int>& nodes : {some_nodes, std::vector<int>(10, 0)}) {
    const Made m(nodes);
    EXPECT_LT((m.N.whole() - m.whole).norm(), 1e-12);
    EXPECT_LT((m.N.diagonal() - m.whole.diagonal()).norm(), 1e-12);
    const VectorXd x = VectorXd::LinSpaced(10, -1.0, 2.0);
    EXPECT_LT((m.N.times(x) - m.whole * x).norm(), 1e-12 * m.whole.norm());
    TieMatrix twice = m.N;
    twice.add(m.N);
    EXPECT_LT((twice.whole() - 2.0 * m.whole).norm(), 1e-12);
  }
}

TEST(TieMatrix, InverseOfUnknownsThatShareANodeOrAnObservation) {
  for (const std::vector<int>& nodes : {some_nodes, std::vector<int>(10, 0)}) {
    const Made m(nodes);
    TieInverse inverse(m.N);
    EXPECT_GT(inverse.smallest_pivot(), 1e-6);
    const MatrixXd C = m.whole.inverse();
    EXPECT_LT((inverse.solve(MatrixXd::Identity(10, 10)) - C).norm(), 1e-9 * C.norm());
    inverse.invert();
    EXPECT_LT((inverse.diagonal() - C.diagonal()).norm(), 1e-9 * C.norm());
    for (const std::vector<int>& numbers : {std::vector<int>{9, 1, 6, 3}, {3, 0, 8}, {7, 5, 2, 6}, {4}})
      EXPECT_LT((inverse.of(numbers) - C(numbers, numbers)).norm(), 1e-9 * C.norm());
  }
}

TEST(TieMatrix, WhatIsNotDeterminedIsSeen) {
  TieMatrix N = TieMatrix::dense(3);
  N.add({0, 1, 2}, MatrixXd::Ones(3, 3));
  EXPECT_LE(TieInverse(N).smallest_pivot(), 1e-13);
  N.add({0, 1, 2}, MatrixXd::Identity(3, 3));
  EXPECT_GT(TieInverse(N).smallest_pivot(), 0.1);
}

}  // namespace
}  // namespace swath::calib
