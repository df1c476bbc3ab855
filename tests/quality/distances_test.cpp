// SPDX-License-Identifier: GPL-3.0-or-later
#include "quality/distances.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace swath::quality {
namespace {

TEST(Distances, AreThoseOfTheNearestCell) {
  std::mt19937 random(3);
  for (const double share : {0.0005, 0.01, 0.3}) {
    const int nx = 61, ny = 43;
    std::vector<std::uint8_t> mask(static_cast<size_t>(nx * ny));
    std::bernoulli_distribution set(share);
    for (auto& m : mask) m = set(random);
    mask[static_cast<size_t>(random() % mask.size())] = 1;
    const std::vector<float> d = squared_distances(mask, nx, ny);
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i) {
        int nearest = 1 << 30;
        for (int v = 0; v < ny; ++v)
          for (int u = 0; u < nx; ++u)
            if (mask[static_cast<size_t>(v * nx + u)]) nearest = std::min(nearest, (u - i) * (u - i) + (v - j) * (v - j));
        ASSERT_EQ(d[static_cast<size_t>(j * nx + i)], static_cast<float>(nearest)) << share << " " << i << " " << j;
      }
  }
}

TEST(Distances, CellsWithinARadiusAreThoseOfTheirSquares) {
  std::mt19937 random(5);
  for (const double share : {0.0, 0.0005, 0.01, 0.3})
    for (const double radius : {0.0, 0.9, 1.0, 1.42, 5.5, 8.0, 40.0}) {
      const int nx = 61, ny = 43;
      std::vector<std::uint8_t> mask(static_cast<size_t>(nx * ny));
      std::bernoulli_distribution set(share);
      for (auto& m : mask) m = set(random) ? 3 : 0;
      const std::vector<float> d = squared_distances(mask, nx, ny);
      const std::vector<std::uint8_t> within = cells_within(mask, nx, ny, radius);
      for (size_t c = 0; c < d.size(); ++c)
        ASSERT_EQ(within[c], static_cast<double>(d[c]) <= radius * radius) << share << " " << radius << " " << c;
    }
}

TEST(Distances, OfAnEmptyMaskAreInfinite) {
  for (const float d : squared_distances(std::vector<std::uint8_t>(12, 0), 4, 3)) EXPECT_TRUE(std::isinf(d));
}

}  // namespace
}  // namespace swath::quality
