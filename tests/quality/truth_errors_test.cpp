// SPDX-License-Identifier: GPL-3.0-or-later
#include "quality/truth_errors.h"

#include <gtest/gtest.h>

#include <cmath>

namespace swath::quality {
namespace {

using core::point_class::ground;
constexpr int building = 6;
constexpr double rounding = 1e-9;

/// Points 3 m east and 4 m above the place that is added as the truth, with sigmas of 1 m and 2 m.
core::Block points(std::initializer_list<int> classes) {
  core::Block b;
  b.origin = {1000, 2000, 0};
  for (const int c : classes) {
    b.x.push_back(3), b.y.push_back(0), b.z.push_back(4);
    b.sigma_h.push_back(1), b.sigma_v.push_back(2);
    b.classification.push_back(static_cast<std::uint8_t>(c));
  }
  return b;
}

TEST(TruthErrors, PointsAndLabels) {
  const Eigen::Vector3d place(1000, 2000, 0);
  const core::Block block = points({ground, ground, building, building, building});
  TruthSums sums, more;
  sums.add(block, 0, place, ground);
  sums.add(block, 1, place, building);  // accepted as ground
  more.add(block, 2, place, building);
  more.add(block, 3, place, ground);                               // rejected
  more.add(block, 4, {0, 0, 1e6}, core::point_class::high_noise);  // in the labels alone
  sums.add(more);
  const PointErrors e = point_errors(sums).value();
  EXPECT_EQ(e.compared, 4u);
  EXPECT_NEAR(e.mean[0], 3, rounding);
  EXPECT_NEAR(e.rms[2], 4, rounding);
  EXPECT_NEAR(e.rms_3d, 5, rounding);
  EXPECT_NEAR(e.largest, 5, rounding);
  EXPECT_NEAR(e.error_over_sigma_h.value(), 3, rounding);
  EXPECT_NEAR(e.error_over_sigma_v.value(), 2, rounding);
  const LabelErrors l = label_errors(sums).value();
  EXPECT_NEAR(l.type_1, 50, rounding);
  EXPECT_NEAR(l.type_2, 100.0 / 3, rounding);
  EXPECT_NEAR(l.total, 40, rounding);
  EXPECT_NEAR(l.kappa, 100 * (0.6 - 0.52) / 0.48, 1e-6);
  EXPECT_FALSE(point_errors({}) || label_errors({}));
}

TEST(TruthErrors, WaterIsLeftOutWhereNothingIsClassifiedAsWater) {
  constexpr int water = core::point_class::water;
  const Eigen::Vector3d place(1000, 2000, 0);
  const core::Block block = points({ground, ground, ground, building, water});
  TruthSums without, with;
  for (size_t i = 0; i < 4; ++i) without.add(block, i, place, i < 1 ? ground : i < 3 ? water : building);
  const LabelErrors l = label_errors(without).value();
  EXPECT_NEAR(l.type_2, 0, rounding);
  EXPECT_NEAR(l.total, 0, rounding);
  EXPECT_EQ(l.water_left_out, 2u);
  with.add(without);
  with.add(block, 4, place, water);
  EXPECT_NEAR(label_errors(with).value().type_2, 50, rounding) << "two of three on water and the building";
  EXPECT_EQ(label_errors(with).value().water_left_out, 0u);
}

TEST(TruthErrors, Terrain) {
  core::Grid model({1.0, 0, 0, 4, 1}), truth = model;
  for (size_t k = 0; k < 4; ++k) {
    truth.height[k] = 10;
    truth.reason[k] = core::Void::none;
    if (k == 3) continue;  // a void of the model
    model.height[k] = 10.0F + 0.25F * static_cast<float>(k);
    model.reason[k] = core::Void::none;
  }
  TerrainSums sums;
  sums.add(model, truth, 1.0);
  const TerrainErrors e = sums.errors();
  EXPECT_EQ(e.cells, 3u);
  EXPECT_NEAR(e.mean.value(), 0.25, rounding);
  EXPECT_NEAR(e.rms.value(), std::sqrt((0.0625 + 0.25) / 3), rounding);
  EXPECT_NEAR(e.median_abs.value(), 0.25, rounding);
  EXPECT_NEAR(e.abs_95.value(), 0.5, rounding);
  EXPECT_NEAR(e.truth_without_height.value(), 25, rounding);
  EXPECT_EQ(TerrainSums().errors().cells, 0u);
  EXPECT_FALSE(TerrainSums().errors().mean.has_value());
}

}  // namespace
}  // namespace swath::quality
