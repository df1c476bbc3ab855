// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/ground/linear_prediction.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <utility>
#include <vector>

namespace swath::filters {
namespace {

using Points = std::vector<Eigen::Vector3d>;

Points grid(const std::function<double(double, double)>& height) {
  Points out;
  for (int j = -5; j < 5; ++j)
    for (int i = -5; i < 5; ++i) out.emplace_back(i + 0.5, j + 0.5, height(i + 0.5, j + 0.5));
  return out;
}

TEST(LinearPrediction, WeightsAreOneBelowAndHalfAtTheHalfWidth) {
  EXPECT_EQ(one_sided_weight(-5.0, -0.1, 0.3), 1.0);
  EXPECT_EQ(one_sided_weight(-0.1, -0.1, 0.3), 1.0);
  EXPECT_NEAR(one_sided_weight(0.2, -0.1, 0.3), 0.5, 1e-12);
  EXPECT_EQ(one_sided_weight(1.0, -0.1, 0.3), 0.0);
}

TEST(LinearPrediction, APlaneComesBack) {
  const auto plane = [](double x, double y) { return 100.0 + 0.4 * x - 0.2 * y; };
  const PredictedSurface s = predict_robustly(grid(plane), {});
  constexpr double held_to_level = 1e-4;  // m: the weak observation of a level plane
  for (const auto& [x, y] : {std::pair{0.0, 0.0}, {3.3, -4.1}, {-4.9, 4.9}}) EXPECT_NEAR(s.height(x, y), plane(x, y), held_to_level);
}

TEST(LinearPrediction, ASmoothSurfaceIsFollowedToItsNoise) {
  const auto hill = [](double x, double y) { return 100.0 + 1.5 * std::exp(-(x * x + y * y) / 12.0); };
  std::mt19937 random(4);
  std::normal_distribution<double> noise(0.0, 0.05);
  Points points = grid(hill);
  for (auto& p : points) p.z() += noise(random);
  const PredictedSurface s = predict_robustly(points, {0.05, 0.5, 2.0});
  double sum = 0;
  for (const auto& p : points) sum += std::pow(s.height(p.x(), p.y()) - hill(p.x(), p.y()), 2);
  EXPECT_LT(std::sqrt(sum / static_cast<double>(points.size())), 0.05);  // better than one point
}

TEST(LinearPrediction, VegetationAboveTheGroundHasNoInfluence) {
  const auto ground = [](double x, double y) { return 100.0 + 0.1 * x + 0.2 * y; };
  std::mt19937 random(7);
  std::uniform_real_distribution<double> part(0.0, 1.0);
  Points points = grid(ground);
  for (auto& p : points)
    if (part(random) < 0.4) p.z() += 2.0 + 10.0 * part(random);
  const PredictedSurface s = predict_robustly(points, {});
  constexpr double bearable = 0.1;  // m: under the trees the surface is carried by its neighbours
  for (const auto& p : points) EXPECT_NEAR(s.height(p.x(), p.y()), ground(p.x(), p.y()), bearable);
}

TEST(LinearPrediction, FewPointsGiveASurfaceToo) {
  EXPECT_TRUE(predict_robustly({}, {}).empty());
  EXPECT_NEAR(predict_robustly({{1.0, 2.0, 50.0}}, {}).height(3.0, 3.0), 50.0, 0.5);
  const PredictedSurface line = predict_robustly({{0.0, 0.0, 50.0}, {2.0, 0.0, 51.0}, {4.0, 0.0, 52.0}}, {});
  EXPECT_NEAR(line.height(3.0, 0.0), 51.5, 0.05);
}

}  // namespace
}  // namespace swath::filters
