// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/checks/moved_residuals.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "calib/block/block_start.h"
#include "tests/calib/block/made_block.h"

namespace swath::calib {
namespace {

/// A copy of the block, all its points intersected.
std::vector<double> of_all_points(ImageBlock block) {
  intersect_points(block);
  std::vector<double> out;
  for (const ImageRay& r : tie_rays(block)) out.push_back(ray_residual(block, r) / block.cameras[0].value[0]);
  return out;
}

ImageBlock made() {
  ImageBlock block = test::make_block(test::Making()).given;
  block.control.front().check = true;
  return block;
}

double mean_of(const std::vector<double>& residuals) {
  double sum = 0.0;
  for (const double v : residuals) sum += std::min(MovedResiduals::at_most, v);
  return sum / static_cast<double>(residuals.size());
}

TEST(MovedResiduals, AreThoseOfTheWholeBlockToTheLastBit) {
  constexpr double rounding = 1e-12;  // of a sum that each move changes
  const ImageBlock block = made();
  MovedResiduals residuals(block);
  const std::vector<double> stated = of_all_points(block);
  EXPECT_EQ(residuals.all(), stated);
  ASSERT_LT(tie_rays(block).size(), block.rays.size());  // some are of control
  ImageBlock moved = block;
  for (std::uint32_t i = 0; i < block.images.size(); i += 3) {
    moved.images[i].position = block.images[(i + 1) % block.images.size()].position;
    residuals.move(i, moved.images[i].position);
    const std::vector<double> expected = of_all_points(moved);
    EXPECT_NE(expected, stated);
    EXPECT_EQ(residuals.all(), expected) << i;
    EXPECT_NEAR(residuals.mean(), mean_of(expected), rounding);
  }
  for (std::uint32_t i = 0; i < block.images.size(); ++i) residuals.move(i, block.images[i].position);
  EXPECT_EQ(residuals.all(), stated);
  EXPECT_NEAR(residuals.mean(), mean_of(stated), rounding);
}

TEST(MovedResiduals, TheMeanOnImagesIsThatOfTheirPoints) {
  const ImageBlock block = made();
  const MovedResiduals residuals(block);
  std::vector<char> seen(block.points.size(), 0);
  for (const ImageRay& r : block.rays)
    if (r.image == 2 || r.image == 7) seen[r.point] = 1;
  std::vector<double> expected;
  const std::vector<ImageRay> rays = tie_rays(block);
  for (size_t k = 0; k < rays.size(); ++k)
    if (seen[rays[k].point]) expected.push_back(residuals.all()[k]);
  ASSERT_LT(expected.size(), rays.size());
  EXPECT_DOUBLE_EQ(residuals.mean_on({2, 7}), mean_of(expected));
}

TEST(MovedResiduals, APointOfParallelRaysStaysWhereItWasGiven) {
  ImageBlock block = made();
  block.images[1].camera_R_local = block.images[0].camera_R_local;
  const auto point = static_cast<std::uint32_t>(block.points.size());
  block.points.push_back({"parallel", block.images[0].position - Eigen::Vector3d(0.0, 0.0, 3000.0)});
  for (const std::uint32_t image : {0u, 1u}) block.rays.push_back({image, point, 1.0, 2.0, 0.01});
  ImageBlock moved = block;
  MovedResiduals residuals(block);
  const double before = residuals.all().back();
  for (std::uint32_t i = 0; i < block.images.size(); ++i) {
    moved.images[i].position += Eigen::Vector3d(400.0, 0.0, 0.0);
    residuals.move(i, moved.images[i].position);
  }
  EXPECT_EQ(residuals.all(), of_all_points(moved));
  EXPECT_NE(residuals.all().back(), before);
}

}  // namespace
}  // namespace swath::calib
