// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/checks/moved_residuals.h"

#include <gtest/gtest.h>

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

TEST(MovedResiduals, AreThoseOfTheWholeBlockToTheLastBit) {
  const ImageBlock block = made();
  MovedResiduals residuals(block);
  EXPECT_EQ(residuals.stated(), of_all_points(block));
  ASSERT_LT(tie_rays(block).size(), block.rays.size());  // some are of control
  for (size_t first = 0; first < block.images.size(); first += 3) {
    ImageBlock moved = block;
    for (size_t i = first; i < std::min(first + 4, block.images.size()); ++i)
      moved.images[i].position = block.images[(i + 1) % block.images.size()].position;
    const std::vector<double> expected = of_all_points(moved);
    EXPECT_NE(expected, residuals.stated());
    EXPECT_EQ(residuals.at(moved), expected) << first;
  }
  EXPECT_EQ(residuals.at(block), residuals.stated());
}

TEST(MovedResiduals, APointOfParallelRaysStaysWhereItWasGiven) {
  ImageBlock block = made();
  block.images[1].camera_R_local = block.images[0].camera_R_local;
  const auto point = static_cast<std::uint32_t>(block.points.size());
  block.points.push_back({"parallel", block.images[0].position - Eigen::Vector3d(0.0, 0.0, 3000.0)});
  for (const std::uint32_t image : {0u, 1u}) block.rays.push_back({image, point, 1.0, 2.0, 0.01});
  ImageBlock moved = block;
  for (BlockImage& i : moved.images) i.position += Eigen::Vector3d(400.0, 0.0, 0.0);
  MovedResiduals residuals(block);
  EXPECT_EQ(residuals.at(moved), of_all_points(moved));
  EXPECT_NE(residuals.at(moved).back(), residuals.stated().back());
}

}  // namespace
}  // namespace swath::calib
