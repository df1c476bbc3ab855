// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/unfit_points.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace swath::calib
