// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/sparse/node_matrix.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <random>
#include <set>

namespace swath::calib {
namespace {

using Eigen::MatrixXd;

/// Nodes of 1 to 6 unknowns on a lattice, and two that many are tied to; diagonals spread over twelve decades.
struct Made {
  std::vector<int> sizes;
  std::vector<std::pair<int, int>> ties;
  MatrixXd dense;
  std::vector<std::vector<int>> cliques;

  NodeMatrix sparse() const {
    NodeMatrix N(sizes);
    for (int a = 0; a < N.nodes(); ++a) N.add(a, a, dense.block(N.first(a), N.first(a), N.size(a), N.size(a)));
    for (const auto& [a, b] : ties) N.add(a, b, dense.block(N.first(a), N.first(b), N.size(a), N.size(b)));
    return N;
  }
};

Made make(int side) {
  Made m;
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  for (int i = 0; i < side * side + 2; ++i) m.sizes.push_back(1 + i % 6);
  std::vector<int> first{0};
  for (const int s : m.sizes) first.push_back(first.back() + s);
  const int common = side * side;
  m.dense = MatrixXd::Identity(first.back(), first.back()) * 1e-3;
  std::set<std::pair<int, int>> ties;
  for (int y = 0; y + 1 < side; ++y)
    for (int x = 0; x + 1 < side; ++x) {
      std::vector<int> clique{side * y + x, side * y + x + 1, side * y + side + x, side * y + side + x + 1, common + (x + y) % 2};
      for (int row = 0; row < 9; ++row) {
        Eigen::VectorXd a = Eigen::VectorXd::Zero(first.back());
        for (const int c : clique)
          for (int k = 0; k < m.sizes[static_cast<size_t>(c)]; ++k)
            a[first[static_cast<size_t>(c)] + k] = normal(random) * std::pow(10.0, k);
        m.dense += a * a.transpose();
      }
      for (const int a : clique)
        for (const int b : clique)
          if (a > b) ties.insert({a, b});
      m.cliques.push_back(clique);
    }
  m.ties.assign(ties.begin(), ties.end());
  return m;
}

TEST(NodeMatrix, TheInverseOnTheFactorsPatternIsThatOfTheWholeMatrix) {
  const Made m = make(6);
  const NodeMatrix N = m.sparse();
  NodeFactor factor(N);
  factor.invert();
  const MatrixXd scale = m.dense.diagonal().cwiseSqrt().asDiagonal();
  const MatrixXd inverse = scale.inverse() * (scale.inverse() * m.dense * scale.inverse()).inverse() * scale.inverse();
  for (const std::vector<int>& clique : m.cliques) {
    const MatrixXd C = factor.covariance(clique);
    int row = 0;
    for (const int a : clique) {
      int column = 0;
      for (const int b : clique) {
        const MatrixXd expected = inverse.block(N.first(a), N.first(b), N.size(a), N.size(b));
        const MatrixXd found = C.block(row, column, N.size(a), N.size(b));
        for (Eigen::Index i = 0; i < expected.rows(); ++i)
          for (Eigen::Index j = 0; j < expected.cols(); ++j) {
            const double size = std::sqrt(inverse(N.first(a) + i, N.first(a) + i) * inverse(N.first(b) + j, N.first(b) + j));
            EXPECT_NEAR(found(i, j) / size, expected(i, j) / size, 1e-8);  // correlations; condition 1e6
          }
        column += N.size(b);
      }
      row += N.size(a);
    }
  }
}

TEST(NodeMatrix, TheInverseAloneIsTheSame) {
  const Made m = make(6);
  NodeFactor with(m.sparse()), alone(m.sparse());
  with.invert();
  alone.invert(NodeFactor::Keep::inverse_alone);
  for (const std::vector<int>& clique : m.cliques) EXPECT_EQ(with.covariance(clique), alone.covariance(clique));
}

TEST(NodeMatrix, FrontsOfManyUnknownsAreInvertedAsWell) {
  // Nine panels in one front, which threads share.
  NodeMatrix N({300, 130, 40});
  const MatrixXd A = MatrixXd::Random(600, N.unknowns()), dense = A.transpose() * A;
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b <= a; ++b) N.add(a, b, dense.block(N.first(a), N.first(b), N.size(a), N.size(b)));
  NodeFactor factor(N);
  const MatrixXd x = MatrixXd::Random(N.unknowns(), 1);
  EXPECT_LT((factor.solve(dense * x) - x).cwiseAbs().maxCoeff(), 1e-9);  // condition 1e3
  factor.invert();
  const MatrixXd inverse = dense.inverse();
  EXPECT_LT((factor.covariance({0, 1, 2}) - inverse).cwiseAbs().maxCoeff(), 1e-9 * inverse.cwiseAbs().maxCoeff());
}

TEST(NodeMatrix, SolvesEquations) {
  const Made m = make(5);
  const NodeMatrix N = m.sparse();
  const NodeFactor factor(N);
  MatrixXd x = MatrixXd::Random(N.unknowns(), 2);
  const MatrixXd b = m.dense * x;
  const MatrixXd found = factor.solve(b);
  for (Eigen::Index i = 0; i < x.rows(); ++i) EXPECT_NEAR(found(i, 0) * std::sqrt(m.dense(i, i)), x(i, 0) * std::sqrt(m.dense(i, i)), 1e-5);
}

TEST(NodeMatrix, ASingularMatrixShowsInItsPivots) {
  NodeMatrix N({2, 2});
  Eigen::Matrix2d one = Eigen::Matrix2d::Identity();
  N.add(0, 0, one), N.add(1, 1, one), N.add(0, 1, one);  // x0 + x1 alone is known
  EXPECT_LE(NodeFactor(N).smallest_pivot(), 1e-13);
  NodeMatrix unknown({2});
  EXPECT_LE(NodeFactor(unknown).smallest_pivot(), 1e-13);
}

}  // namespace
}  // namespace swath::calib
