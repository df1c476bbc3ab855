// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/ground/crests.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "filters/ground/inpaint.h"

namespace swath::filters {
namespace {

constexpr int size = 100, middle = 50, widest = 12;
constexpr float level = 100.0F;

Raster raster(const std::function<double(int i, int j)>& height) {
  Raster r(size, size, level);
  for (int j = 0; j < size; ++j)
    for (int i = 0; i < size; ++i) r.value[r.at(i, j)] = static_cast<float>(height(i, j));
  return r;
}

Raster without(Raster r, const std::function<bool(int i, int j)>& off) {
  for (int j = 0; j < size; ++j)
    for (int i = 0; i < size; ++i)
      if (off(i, j)) r.value[r.at(i, j)] = std::nanf("");
  return r;
}

/// Number of the cells of `lowest` that are not in `ground`, after what restore_crests() puts back.
int left_off(const Raster& lowest, const Raster& filled, Raster& ground) {
  const Raster opened = open_disk(filled, widest);
  restore_crests(ground, {lowest, filled, opened, widest});
  int n = 0;
  for (size_t c = 0; c < lowest.value.size(); ++c) n += !std::isnan(lowest.value[c]) && std::isnan(ground.value[c]);
  return n;
}

int left_off(const Raster& lowest, Raster& ground) { return left_off(lowest, inpaint(lowest, {}), ground); }

double ridge(int i, int) { return level - 0.7 * std::abs(i - middle); }
bool on_ridge(int i, int half) { return std::abs(i - middle) <= half; }

TEST(Crests, ARidgeThatWasCutOffComesBack) {
  const Raster lowest = raster(ridge);
  Raster ground = without(lowest, [](int i, int) { return on_ridge(i, 5); });
  EXPECT_EQ(left_off(lowest, ground), 0);
}

TEST(Crests, ARidgeComesBackWhereReturnsAreSparse) {
  const Raster lowest = without(raster(ridge), [](int i, int j) { return i % 3 != 0 || j % 3 != 0; });
  Raster ground = without(lowest, [](int i, int) { return on_ridge(i, 6); });
  EXPECT_EQ(left_off(lowest, ground), 0);
}

TEST(Crests, TheRimOfABreakComesBack) {
  // A slope up to a cliff.
  const Raster lowest = raster([](int i, int) { return i <= middle ? level + 0.5 * (i - middle) : level - 30.0; });
  Raster ground = without(lowest, [](int i, int) { return i <= middle && i > middle - 5; });
  EXPECT_EQ(left_off(lowest, ground), 0);
}

TEST(Crests, TheTopOfAPileComesBack) {
  for (const double degrees : {30.0, 36.0, 40.0}) {
    const double steep = std::tan(degrees * M_PI / 180.0);
    const Raster lowest =
        raster([&](int i, int j) { return level + std::max(0.0, steep * (18.0 - std::hypot(1.0, std::hypot(i - middle, j - middle)))); });
    Raster ground = without(lowest, [](int i, int j) { return std::hypot(i - middle, j - middle) <= 9.0; });
    EXPECT_LE(left_off(lowest, ground), 1) << degrees;  // of 253: the apex may stay off
  }
}

TEST(Crests, ABenchBetweenTwoWallsStaysOff) {
  // Deck, dam of concrete, ramp: level with the ground at both ends, sheer on both sides.
  const auto bench = [](int i, int j) { return std::abs(i - middle) <= 3 && std::abs(j - middle) <= 20; };
  for (const double height : {2.0, 4.0}) {
    const Raster lowest = raster([&](int i, int j) { return std::abs(j - middle) <= 20 && !bench(i, j) ? level - height : level; });
    Raster ground = without(lowest, bench);
    EXPECT_EQ(left_off(lowest, ground), 7 * 41) << height;
  }
}

TEST(Crests, ADeckOverWaterWithoutReturnsStaysOff) {
  // What fills the water beside the deck falls from its edge as a slope of 20 deg.
  const auto deck = [](int i, int j) { return std::abs(i - middle) <= 4 && std::abs(j - middle) <= 20; };
  const auto water = [&](int i, int j) { return std::abs(j - middle) <= 20 && std::abs(i - middle) > 4; };
  const Raster filled = raster([&](int i, int j) { return water(i, j) ? level - 0.36 * std::min(std::abs(i - middle) - 4, 12) : level; });
  const Raster lowest = without(filled, water);
  Raster ground = without(lowest, deck);
  EXPECT_EQ(left_off(lowest, filled, ground), 9 * 41);
}

TEST(Crests, RoofsStayOff) {
  // On level ground, and on a slope whose upper side the eaves touch.
  for (const double slope : {0.0, 0.5}) {
    const auto roof = [](int i, int j) { return std::abs(i - middle) <= 8 && std::abs(j - middle) <= 6; };
    const auto terrain = [&](int i) { return level + slope * (i - middle); };
    const Raster lowest = raster([&](int i, int j) { return roof(i, j) ? terrain(middle + 8) + 2.0 * (slope == 0.0) : terrain(i); });
    Raster ground = without(lowest, roof);
    EXPECT_EQ(left_off(lowest, ground), 17 * 13) << slope;
  }
}

TEST(Crests, ADeckDoesNotGrowFromItsBanks) {
  const auto deck = [](int i, int j) { return std::abs(i - middle) <= 4 && std::abs(j - middle) <= 10; };
  const Raster lowest = raster([&](int i, int j) { return std::abs(j - middle) <= 10 && !deck(i, j) ? level - 5.0 : level; });
  Raster ground = without(lowest, deck);
  EXPECT_EQ(left_off(lowest, ground), 9 * 21);
}

TEST(Crests, BushesOnLevelGroundStayOff) {
  const auto bush = [](int i, int j) { return (i * 7 + j * 3) % 5 == 0; };
  const Raster lowest = raster([&](int i, int j) { return bush(i, j) ? level + 0.3 + 0.1 * ((i + j) % 9) : level; });
  Raster ground = without(lowest, bush);
  EXPECT_EQ(left_off(lowest, ground), size * size / 5);
}

TEST(Crests, TheSupportIsAsFarAsTheRimGrows) {
  // A rim whose ground is known up to a row: from there it grows along the cliff.
  const Raster lowest = without(raster([](int i, int) { return i <= middle ? level + 0.5 * (i - middle) : level - 30.0; }),
                                [](int i, int j) { return i % 3 != 2 || j % 3 != 0; });
  const auto known_to = [&](int row) { return without(lowest, [row](int i, int j) { return i <= middle && j > row; }); };
  Raster ground = known_to(12), less = known_to(9);
  left_off(lowest, ground), left_off(lowest, less);
  int farthest = 0;
  for (int j = 0; j < size; ++j)
    for (int i = 0; i < size; ++i)
      if (std::isnan(ground.value[ground.at(i, j)]) != std::isnan(less.value[less.at(i, j)])) farthest = j;
  EXPECT_GT(farthest, 12 + crest_support / 2);
  EXPECT_LE(farthest, 12 + crest_support);
}

}  // namespace
}  // namespace swath::filters
