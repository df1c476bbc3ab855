// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/sparse/dense_product.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>

namespace swath::calib {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

MatrixXd numbers(Index rows, Index columns, int seed) {
  std::mt19937 dice(static_cast<unsigned>(seed));
  return MatrixXd::NullaryExpr(rows, columns, [&] { return std::uniform_real_distribution<double>(-1.0, 1.0)(dice); });
}

/// One sum after another, in the stretches that every processor is to take.
MatrixXd one_by_one(MatrixXd C, const MatrixXd& A, const MatrixXd& B) {
  for (Index from = 0; from < A.cols(); from += 256)
    for (Index j = 0; j < C.cols(); ++j)
      for (Index i = 0; i < C.rows(); ++i) {
        double sum = 0.0;
        for (Index k = from; k < std::min(A.cols(), from + 256); ++k) sum += A(i, k) * B(k, j);
        C(i, j) -= sum;
      }
  return C;
}

/// Whichever kernel this processor takes. Parts of larger matrices, so that columns do not follow one another without a gap.
TEST(DenseProduct, IsTheSameToTheBitAsOneSumAfterAnother) {
  const MatrixXd left = numbers(310, 600, 1), right = numbers(600, 310, 2);
  for (const auto& [rows, depth, columns] :
       {std::array<Index, 3>{1, 1, 1}, {8, 4, 4}, {7, 3, 5}, {97, 257, 65}, {300, 513, 3}, {5, 600, 300}, {100, 0, 4}, {0, 5, 4}}) {
    const MatrixXd before = numbers(rows + 3, columns + 2, 3);
    const MatrixXd A = left.block(4, 0, rows, depth), B = right.block(0, 7, depth, columns);
    const MatrixXd expected = one_by_one(before.block(2, 1, rows, columns), A, B);
    MatrixXd C = before;
    subtract_product(C.block(2, 1, rows, columns), MatrixView::of(left.block(4, 0, rows, depth)),
                     MatrixView::of(right.block(0, 7, depth, columns)));
    EXPECT_EQ(C.block(2, 1, rows, columns), expected);
    C.block(2, 1, rows, columns) = before.block(2, 1, rows, columns);
    EXPECT_EQ(C, before) << "nothing beside it is touched";

    // Turned, the product is the same: C^T -= B^T A^T.
    MatrixXd turned = before.block(2, 1, rows, columns).transpose();
    subtract_product(turned, MatrixView::of(right.block(0, 7, depth, columns)).transposed(),
                     MatrixView::of(left.block(4, 0, rows, depth)).transposed());
    EXPECT_EQ(turned.transpose(), expected);
  }
}

}  // namespace
}  // namespace swath::calib
