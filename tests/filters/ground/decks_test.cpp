// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/ground/decks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

namespace swath::filters {
namespace {

constexpr int size = 80;
constexpr float level = 100.0F;

/// A ditch along rows 30 to 50 with flanks of `flank` (rise / run) and `depth` m; over it, columns 36 to 44, what `over` gives.
Raster crossed_ditch(double flank, double depth, const std::function<float(float ground, int j)>& over) {
  Raster r(size, size, level);
  for (int j = 0; j < size; ++j)
    for (int i = 0; i < size; ++i) {
      const double inside = 10.5 - std::abs(j - 40);
      const float ground = level - static_cast<float>(std::clamp(flank * inside, 0.0, depth));
      r.value[r.at(i, j)] = i >= 36 && i <= 44 ? over(ground, j) : ground;
    }
  return r;
}

float deck(float, int) { return level; }

/// The surface without rows `from` to `to` of the columns 36 to 44.
Raster without_middle(const Raster& r, int from, int to) {
  Raster out = r;
  for (int j = from; j <= to; ++j)
    for (int i = 36; i <= 44; ++i) out.value[out.at(i, j)] = std::nanf("");
  return out;
}

int voids(const Raster& r) {
  int n = 0;
  for (const float v : r.value) n += std::isnan(v);
  return n;
}

TEST(Decks, TheEndsGoWithTheMiddleAndTheBanksStay) {
  Raster surface = crossed_ditch(0.67, 5.0, deck);
  Raster ground = without_middle(surface, 36, 44);
  remove_decks(ground, surface, {});
  for (int j = 0; j < size; ++j)
    for (int i = 0; i < size; ++i) {
      const size_t c = ground.at(i, j);
      const bool on_deck = i >= 36 && i <= 44 && std::abs(j - 40) <= 10;
      // Where the deck stands less than the step over the flank it may be ground.
      if (!on_deck || std::abs(j - 40) <= 9) {
        EXPECT_EQ(std::isnan(ground.value[c]), on_deck) << i << " " << j;
        EXPECT_EQ(std::isnan(surface.value[c]), on_deck) << i << " " << j;
      }
    }
}

TEST(Decks, AnEmbankmentStaysWhateverWasTakenOffOnIt) {
  // A dam whose sides fall as steeply as ground can: 55 degrees.
  Raster surface(size, size, level);
  for (int j = 0; j < size; ++j)
    for (int i = 0; i < size; ++i)
      surface.value[surface.at(i, j)] = level - static_cast<float>(std::clamp(1.43 * (std::abs(i - 40) - 4.0), 0.0, 8.0));
  Raster ground = without_middle(surface, 36, 44);
  const int before = voids(ground);
  remove_decks(ground, surface, {});
  EXPECT_EQ(voids(ground), before);
}

TEST(Decks, ARoofBesideLevelGroundTakesNoneOfItAlong) {
  Raster surface(size, size, level);
  for (int j = 30; j <= 50; ++j)
    for (int i = 36; i <= 44; ++i) surface.value[surface.at(i, j)] = level + 6.0F;
  Raster ground = without_middle(surface, 30, 50);
  const int before = voids(ground);
  remove_decks(ground, surface, {});
  EXPECT_EQ(voids(ground), before);
}

TEST(Decks, NothingHappensBeyondTheSupport) {
  Raster surface = crossed_ditch(0.67, 5.0, deck);
  Raster ground = without_middle(surface, 36, 44);
  remove_decks(ground, surface, {});
  for (int j = 0; j < size; ++j)
    for (int i = 0; i < size; ++i)
      if (std::isnan(ground.value[ground.at(i, j)])) {
        EXPECT_LT(std::hypot(std::max(0, std::abs(i - 40) - 4), std::max(0, std::abs(j - 40) - 4)), deck_support);
      }
}

}  // namespace
}  // namespace swath::filters
