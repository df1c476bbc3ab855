// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/ground/morphology.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <random>

namespace swath::filters {
namespace {

constexpr float nothing = std::numeric_limits<float>::quiet_NaN();

/// The definition, word by word.
Raster opening_by_definition(const Raster& f, int radius) {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  Raster out = f;
  for (int j = 0; j < f.ny; ++j)
    for (int i = 0; i < f.nx; ++i) {
      if (std::isnan(f.value[f.at(i, j)])) continue;
      float largest = -infinity;
      for (int b = -radius; b <= radius; ++b)
        for (int a = -radius; a <= radius; ++a) {
          if (a * a + b * b > radius * radius || !f.holds(i + a, j + b)) continue;
          float smallest = infinity;
          for (int d = -radius; d <= radius; ++d)
            for (int c = -radius; c <= radius; ++c) {
              if (c * c + d * d > radius * radius || !f.holds(i + a + c, j + b + d)) continue;
              const float v = f.value[f.at(i + a + c, j + b + d)];
              if (v < smallest) smallest = v;
            }
          largest = std::max(largest, smallest);
        }
      out.value[out.at(i, j)] = largest;
    }
  return out;
}

Raster noisy(int nx, int ny, double holes) {
  Raster r(nx, ny, 0.0F);
  std::mt19937 random(7);
  std::uniform_real_distribution<float> height(-20, 20);
  std::bernoulli_distribution hole(holes);
  for (float& v : r.value) v = hole(random) ? nothing : height(random);
  return r;
}

TEST(Morphology, OpeningAndClosingFollowTheDefinition) {
  const Raster f = noisy(31, 23, 0.2);
  for (const int radius : {0, 1, 2, 3, 5}) {
    const Raster expected = opening_by_definition(f, radius);
    const Raster got = open_disk(f, radius);
    Raster upside_down = f;
    for (float& v : upside_down.value) v = -v;
    const Raster closed = close_disk(upside_down, radius);
    for (size_t c = 0; c < f.value.size(); ++c) {
      ASSERT_EQ(std::isnan(got.value[c]), std::isnan(f.value[c]));
      if (std::isnan(f.value[c])) continue;
      ASSERT_EQ(got.value[c], expected.value[c]) << "radius " << radius << " cell " << c;
      ASSERT_EQ(closed.value[c], -expected.value[c]);
    }
  }
}

TEST(Morphology, OpeningTakesOffWhatTheDiskDoesNotFitInto) {
  Raster f(60, 60, 5.0F);
  for (int j = 20; j < 31; ++j)
    for (int i = 20; i < 31; ++i) f.value[f.at(i, j)] = 12.0F;  // 11 cells wide
  EXPECT_EQ(open_disk(f, 5).value[f.at(25, 25)], 12.0F);
  EXPECT_EQ(open_disk(f, 8).value[f.at(25, 25)], 5.0F);
  EXPECT_EQ(open_disk(f, 8).value[f.at(5, 5)], 5.0F);
}

TEST(Morphology, GranulometryOfAThousandByThousandCellsIsFast) {
  const Raster f = noisy(1000, 1000, 0.1);
  const auto start = std::chrono::steady_clock::now();
  for (int radius = 1; radius <= 18; ++radius) (void)open_disk(f, radius);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  RecordProperty("seconds", std::to_string(seconds));
#ifdef NDEBUG
  constexpr double ample = 5.0;  // takes well under a second on an idle core; the machine may be shared
  EXPECT_LT(seconds, ample);
#endif
}

}  // namespace
}  // namespace swath::filters
