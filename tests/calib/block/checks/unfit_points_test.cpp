// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/checks/unfit_points.h"

#include <gtest/gtest.h>

#include "calib/block/block_adjust.h"
#include "tests/calib/block/made_block.h"

namespace swath::calib {
namespace {

TEST(UnfitPoints, WrongControlAndPointsThatFitOnce) {
  ImageBlock block;
  for (const char* name : {"good", "wrong", "tie", "two_in_one", "once"}) block.points.push_back({name, Eigen::Vector3d::Zero()});
  block.images.resize(2);
  block.images[0].name = "first", block.images[1].name = "lost";
  block.control = {{0, false, {true, true, true}, Eigen::Vector3d::Zero(), Eigen::Vector3d::Ones()},
                   {1, false, {true, true, true}, Eigen::Vector3d::Zero(), Eigen::Vector3d::Ones()}};
  std::vector<double> weight;
  const auto ray = [&](std::uint32_t point, double w) {
    block.rays.push_back({0, point, 0.0, 0.0, 0.01});
    weight.push_back(w);
  };
  ray(0, 1.0), ray(0, 1e-6), ray(0, 1.0);
  ray(1, 1e-6), ray(1, 1e-6), ray(1, 1.0);
  ray(2, 1.0), ray(2, 0.9), ray(2, 1e-6);
  ray(3, 1.0), ray(3, 1e-6), ray(3, 1e-6);
  ray(4, 1.0);
  block.rays.push_back({1, 4, 0.0, 0.0, 0.01}), weight.push_back(1e-6);
  block.rays.push_back({1, 2, 0.0, 0.0, 0.01}), weight.push_back(1.0);
  const UnfitPoints found = unfit_points(block, weight);
  EXPECT_EQ(found.control, std::vector<std::string>{"wrong"});
  EXPECT_EQ(found.others, (std::vector<std::string>{"two_in_one", "once"}));
  EXPECT_EQ(found.images, (std::vector<std::string>{"first", "lost"}));
  EXPECT_EQ(found.of_point, (std::vector<char>{0, 0, 0, 1, 1}));
}

TEST(UnfitPoints, PointsOfParallelRaysAreLeftOut) {
  const BlockOptions plain{.robust = false, .components = false};
  test::Making m;
  m.attitudes = true;
  const test::MadeBlock made = test::make_block(m);
  ImageBlock alone = made.given, doubled = made.given;
  const BlockSolution without = adjust_block(alone, plain);
  // An exposure made twice from one place, and a point that these two images alone see.
  const auto second = static_cast<std::uint32_t>(doubled.images.size());
  const auto point = static_cast<std::uint32_t>(doubled.points.size());
  doubled.images.push_back(doubled.images[0]);
  doubled.images.back().name = "twice";
  doubled.points.push_back({"far", doubled.points[0].position});
  for (const ImageRay& r : made.given.rays)
    if (r.image == 0) doubled.rays.push_back({second, r.point, r.x, r.y, r.sigma});
  for (const std::uint32_t image : {0u, second}) doubled.rays.push_back({image, point, 10.0, -20.0, 0.01});
  for (const ImageAttitude& a : made.given.attitudes)
    if (a.image == 0) doubled.attitudes.push_back({second, a.local_R_body, a.covariance});
  const BlockSolution with = adjust_block(doubled, plain);
  for (std::uint32_t p = 0; p < doubled.points.size(); ++p) EXPECT_EQ(doubled.points[p].left_out, p == point);
  EXPECT_EQ(with.points_left_out, without.points_left_out + 1);
  for (std::uint32_t p = 0; p < point; ++p)
    if (with.linear.point_column[p] >= 0) {
      EXPECT_LT((doubled.points[p].position - alone.points[p].position).norm(), 2.0);
    }
}

}  // namespace
}  // namespace swath::calib
