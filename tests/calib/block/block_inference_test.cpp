// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/block_inference.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "tests/calib/block/made_block.h"

namespace swath::calib {
namespace {

/// Everything from the dense inverse.
TEST(BlockInference, CovariancesAndRedundanciesAreThoseOfTheDenseInverse) {
  ImageBlock block = test::block_with_all_unknowns();
  const LinearBlock l = BlockSystem(block, {}).linearise();
  const int all = l.unknowns + 3 * l.points();
  const Eigen::MatrixXd A = test::dense_rows(l);
  const Eigen::VectorXd s = A.colwise().norm().cwiseInverse();
  const Eigen::MatrixXd scaled = A * s.asDiagonal();
  const Eigen::MatrixXd C = s.asDiagonal() * (scaled.transpose() * scaled).inverse() * s.asDiagonal();
  const BlockInference found = infer(l);
  ASSERT_TRUE(found.determined());
  constexpr double share = 1e-6;  // of a variance; condition 1e5
  for (size_t n = 0; n < l.nodes.size(); ++n)
    for (Eigen::Index k = 0; k < found.nodes[n].rows(); ++k) {
      const double expected = C(l.nodes[n].first + k, l.nodes[n].first + k);
      EXPECT_NEAR(found.nodes[n](k, k), expected, share * expected);
    }
  size_t images = 0;
  for (size_t n = 0; n < l.nodes.size(); ++n) {
    if (l.nodes[n].kind != NodeKind::image) continue;
    ++images;
    ASSERT_GE(found.camera_of[n], 0);
    const UnknownNode& camera = l.nodes[static_cast<size_t>(found.camera_of[n])];
    EXPECT_EQ(camera.kind, NodeKind::camera);
    const Eigen::MatrixXd& with = found.with_camera[n];
    ASSERT_EQ(with.cols(), static_cast<Eigen::Index>(camera.components.size()));
    for (Eigen::Index r = 0; r < with.rows(); ++r)
      for (Eigen::Index k = 0; k < with.cols(); ++k) {
        const int a = l.nodes[n].first + static_cast<int>(r), b = camera.first + static_cast<int>(k);
        EXPECT_NEAR(with(r, k), C(a, b), share * std::sqrt(C(a, a) * C(b, b)));
      }
  }
  EXPECT_EQ(images, block.images.size());
  for (size_t p = 0; p < block.points.size(); ++p)
    for (int k = 0; k < 3; ++k) {
      const double expected = C(l.point_column[p] + k, l.point_column[p] + k);
      EXPECT_NEAR(found.points[p](k, k), expected, share * expected);
    }
  double sum = 0.0;
  for (const BlockObservation& o : l.observations)
    for (size_t row = o.row; row < o.row + static_cast<size_t>(o.rows); ++row) {
      const Eigen::RowVectorXd a = A.row(static_cast<Eigen::Index>(row));
      const double r = 1.0 - (a * C * a.transpose()).value();
      EXPECT_NEAR(found.redundancy[row], r, 1e-5);
      if (o.kind == ObservationKind::ray && r > 0.01) {
        const Eigen::Vector3d moves = C.middleRows(l.point_column[block.rays[o.index].point], 3) * a.transpose();
        EXPECT_NEAR(found.outer[row], moves.norm() * delta0 / std::sqrt(r), 1e-3 * found.outer[row] + 1e-6);
        EXPECT_NEAR(found.w[row], l.residual[row] / std::sqrt(r), 1e-3 * std::abs(l.residual[row] / std::sqrt(r)) + 1e-5);
      }
      sum += r;
    }
  EXPECT_NEAR(sum, static_cast<double>(l.residual.size()) - all, 1e-4);
  EXPECT_NEAR(found.redundancy_of[0] + found.redundancy_of[1] + found.redundancy_of[2] + found.redundancy_of[3] + found.redundancy_of[4],
              sum, 1e-3);
}

}  // namespace
}  // namespace swath::calib
