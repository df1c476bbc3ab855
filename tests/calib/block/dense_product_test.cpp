// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/dense_product.h"

#include <gtest/gtest.h>

#include <array>

namespace swath::calib {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// Parts of larger matrices, so that columns are not side by side without a gap.
TEST(DenseProduct, IsEigensForAnyShape) {
  std::srand(5);
  const MatrixXd left = MatrixXd::Random(310, 600), right = MatrixXd::Random(600, 310);
  for (const auto& [rows, depth, columns] :
       {std::array<Index, 3>{1, 1, 1}, {8, 4, 4}, {7, 3, 5}, {97, 257, 65}, {300, 513, 3}, {5, 600, 300}, {100, 0, 4}, {0, 5, 4}}) {
    const MatrixXd before = MatrixXd::Random(rows + 3, columns + 2);
    const MatrixXd expected = before.block(2, 1, rows, columns) - left.block(4, 0, rows, depth) * right.block(0, 7, depth, columns);
    MatrixXd C = before;
    subtract_product(C.block(2, 1, rows, columns), MatrixView::of(left.block(4, 0, rows, depth)),
                     MatrixView::of(right.block(0, 7, depth, columns)));
    const double rounding = 1e-13 * static_cast<double>(depth + 1);
    EXPECT_LE((C.block(2, 1, rows, columns) - expected).cwiseAbs().sum(), rounding * static_cast<double>(rows * columns));
    C.block(2, 1, rows, columns) = before.block(2, 1, rows, columns);
    EXPECT_EQ(C, before) << "nothing beside it is touched";

    // Turned, the product is the same: C^T -= B^T A^T.
    MatrixXd turned = MatrixXd::Zero(columns, rows);
    subtract_product(turned, MatrixView::of(right.block(0, 7, depth, columns)).transposed(),
                     MatrixView::of(left.block(4, 0, rows, depth)).transposed());
    EXPECT_LE((turned.transpose() - (expected - before.block(2, 1, rows, columns))).cwiseAbs().sum(),
              rounding * static_cast<double>(rows * columns));
  }
}

}  // namespace
}  // namespace swath::calib
