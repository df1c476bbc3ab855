// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/block_normals.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "tests/calib/block/made_block.h"

namespace swath::calib {
namespace {

TEST(BlockNormals, PointsAreEliminatedAsFromTheDenseMatrix) {
  test::Making m;
  m.layout.strips = 2, m.layout.images = 4;
  m.which.drift = DriftSets::block;
  m.camera_sigma[0] = free_value;
  ImageBlock block = test::make_block(m).given;
  const LinearBlock l = BlockSystem(block, {}).linearise();
  const int n = l.unknowns, all = n + 3 * l.points();
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(l.residual.size()), all);
  for (size_t row = 0; row < l.residual.size(); ++row)
    for (size_t k = l.first[row]; k < l.first[row + 1]; ++k) A(static_cast<Eigen::Index>(row), l.column[k]) = l.value[k];
  const Eigen::MatrixXd N = A.transpose() * A;
  const Eigen::MatrixXd S = N.topLeftCorner(n, n) -
                            N.topRightCorner(n, all - n) * N.bottomRightCorner(all - n, all - n).inverse() * N.bottomLeftCorner(all - n, n);
  const BlockNormals normals(l);
  const NodeMatrix found = normals.reduced();
  for (int a = 0; a < found.nodes(); ++a)
    for (int b = 0; b <= a; ++b) {
      const auto block_of = S.block(found.first(a), found.first(b), found.size(a), found.size(b));
      const auto F = found.block(a, b);
      const double scale = std::sqrt(N.block(found.first(a), found.first(a), found.size(a), found.size(a)).norm() *
                                     N.block(found.first(b), found.first(b), found.size(b), found.size(b)).norm());
      if (F.size() == 0)
        EXPECT_LT(block_of.norm(), 1e-9 * scale);
      else
        EXPECT_LT((F - block_of).norm(), 1e-9 * scale);
    }
}

TEST(BlockNormals, ParallelRaysShowInThePointsPivot) {
  ImageBlock block = test::make_block({}).given;
  block.images[1].position = block.images[0].position + Eigen::Vector3d(1e-6, 0, 0);
  block.images[1].camera_R_local = block.images[0].camera_R_local;
  block.rays = {{0, 0, 1, 1, 0.01}, {1, 0, 1, 1, 0.01}};
  block.control.clear();
  const LinearBlock l = BlockSystem(block, {}).linearise();
  EXPECT_LT(BlockNormals(l).part(0).smallest_pivot, 1e-12);
}

}  // namespace
}  // namespace swath::calib
