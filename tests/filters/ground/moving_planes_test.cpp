// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/ground/moving_planes.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>

namespace swath::filters {
namespace {

constexpr int size = 40;

CellSums data_of(const std::function<double(int, int)>& value, const std::function<double(int, int)>& weight) {
  const Raster zeros(size, size, 0.0F);
  CellSums s{zeros, zeros, zeros};
  for (int j = 0; j < size; ++j)
    for (int i = 0; i < size; ++i) {
      const double v = value(i, j), w = weight(i, j);
      const size_t c = zeros.at(i, j);
      s.weight.value[c] = static_cast<float>(w);
      s.value.value[c] = static_cast<float>(w * v);
      s.square.value[c] = static_cast<float>(w * v * v);
    }
  return s;
}

double one(int, int) { return 1.0; }

TEST(MovingPlanes, APlaneComesBackExactlyWhereverItsDataLie) {
  const auto plane = [](int i, int j) { return 2.0 + 0.3 * (i - 20) - 0.2 * (j - 20); };
  const auto gaps = [](int i, int j) { return (i * 7 + j * 11) % 5 == 0 ? 1.0 : 0.0; };
  const PlaneField f = fit_planes(data_of(plane, gaps), 3.0, 1e-6);
  constexpr double of_floats = 2e-3;  // sums of float convolutions at heights of 8
  for (const auto& [i, j] : {std::pair{20, 20}, std::pair{0, 0}, std::pair{39, 7}}) {
    const size_t c = f.height.at(i, j);
    EXPECT_NEAR(f.height.value[c], plane(i, j), of_floats);
    EXPECT_NEAR(f.east.value[c], 0.3, of_floats);
    EXPECT_NEAR(f.north.value[c], -0.2, of_floats);
    EXPECT_NEAR(f.variance.value[c], 0.0, of_floats);
  }
}

TEST(MovingPlanes, LittleDataLeaveThePriorAndNoneLeavesZero) {
  const auto single = [](int i, int j) { return i == 10 && j == 10 ? 1.0 : 0.0; };
  const PlaneField f = fit_planes(data_of([](int, int) { return 4.0; }, single), 2.0, 1.0);
  EXPECT_NEAR(f.height.value[f.height.at(10, 10)], 2.0, 1e-5);  // one datum against one of the prior's
  EXPECT_EQ(f.support.value[f.support.at(10, 10)], 1.0F);
  EXPECT_EQ(f.support.value[f.support.at(30, 30)], 0.0F);
  EXPECT_EQ(f.height.value[f.height.at(30, 30)], 0.0F);
}

TEST(MovingPlanes, VarianceIsThatOfTheDataAboutThePlane) {
  const PlaneField f = fit_planes(data_of([](int i, int j) { return (i + j) % 2 == 0 ? 0.1 : -0.1; }, one), 4.0, 1e-6);
  EXPECT_NEAR(f.variance.value[f.variance.at(20, 20)], 0.01, 1e-4);
}

TEST(MovingPlanes, ABreakIsKeptFromBothSides) {
  const auto crest = [](int i, int) { return i < 20 ? 0.0 : -1.4 * (i - 19.5); };
  const PlaneField f = fit_planes(data_of(crest, one), 2.0, 1e-3);
  const Raster kept = across_breaks(std::array{PlaneChoice{f, 3}}, 0.03);
  double plain = 0.0, worst = 0.0;
  for (int i = 12; i < 28; ++i) {
    const size_t c = kept.at(i, 20);
    plain = std::max(plain, std::abs(f.height.value[c] - crest(i, 20)));
    worst = std::max(worst, std::abs(kept.value[c] - crest(i, 20)));
  }
  EXPECT_GT(plain, 0.5);
  EXPECT_LT(worst, 0.2);
}

TEST(MovingPlanes, FinerPlanesAreTakenWhereTheGroundIsCurved) {
  const auto ridge = [](int i, int) { return -0.15 * (i - 20) * (i - 20); };
  const CellSums data = data_of(ridge, one);
  const PlaneField wide = fit_planes(data, 2.0, 1e-3), fine = fit_planes(data, 1.0, 1e-3);
  const size_t crest = fine.height.at(20, 20);
  const double alone = across_breaks(std::array{PlaneChoice{wide, 2}}, 0.03).value[crest];
  const double both = across_breaks(std::array{PlaneChoice{wide, 2}, PlaneChoice{fine, 1}}, 0.03).value[crest];
  EXPECT_LT(std::abs(both), 0.6 * std::abs(alone));
}

TEST(MovingPlanes, ACellDependsOnItsReachAlone) {
  auto data = data_of([](int i, int j) { return std::sin(i * 0.3) + 0.1 * j; }, one);
  const PlaneField before = fit_planes(data, 2.0, 0.1);
  data.value.value[data.value.at(20 + reach(2.0) + 1, 20)] = 1e6F;
  const PlaneField after = fit_planes(data, 2.0, 0.1);
  EXPECT_EQ(before.height.value[before.height.at(20, 20)], after.height.value[after.height.at(20, 20)]);
  EXPECT_NE(before.height.value[before.height.at(21, 20)], after.height.value[after.height.at(21, 20)]);
}

TEST(MovingPlanes, BlurSumsUnderTheGaussian) {
  Raster r(size, size, 0.0F);
  r.value[r.at(20, 20)] = 3.0F;
  const Raster b = blur(r, 2.0);
  EXPECT_NEAR(b.value[b.at(20, 20)], 3.0, 1e-6);
  EXPECT_NEAR(b.value[b.at(22, 21)], 3.0 * std::exp(-5.0 / 8.0), 1e-5);
}

}  // namespace
}  // namespace swath::filters
