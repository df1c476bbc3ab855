// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/classes/bridges.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace swath::filters {
namespace {

/// A valley along y, 8 m deep, under planes as wanted.
StructureCells valley(const std::function<float(int, int)>& plane, const std::function<float(int, int)>& ground) {
  StructureCells c;
  c.lattice = {1.0, 0, 0, 80, 60};
  const float none = std::numeric_limits<float>::quiet_NaN();
  c.plane.assign(c.lattice.size(), none);
  c.height = c.ground = c.low = c.plane;
  c.kind.assign(c.lattice.size(), Planar::none);
  for (int j = 0; j < 60; ++j)
    for (int i = 0; i < 80; ++i) {
      const size_t at = c.lattice.at(i, j);
      c.plane[at] = plane(i, j);
      if (c.has_plane(at))
        c.height[at] = c.plane[at] - ground(i, j);
      else
        c.ground[at] = ground(i, j);
      c.kind[at] = c.has_plane(at) ? Planar::wide : Planar::none;
      c.low[at] = c.has_plane(at) ? c.plane[at] : c.ground[at];
    }
  return c;
}

std::vector<std::uint8_t> decks_of(const StructureCells& cells, const BridgeLimits& limits) {
  core::Block corners;
  corners.x = {0.0, 80.0}, corners.y = {0.0, 60.0}, corners.z = {0.0, 0.0};
  return deck_cells(cells, limits, OwnBox(corners, 2, 0.0));
}

constexpr float empty = std::numeric_limits<float>::quiet_NaN();
float slopes(int i, int) { return std::abs(i - 40) < 15 ? -8.0f : 0.0f; }

TEST(Bridges, ADeckFromBankToBankIsOneAndARoofInTheValleyIsNot) {
  const auto deck = [](int i, int j) { return std::abs(i - 40) < 15 && std::abs(j - 30) < 4 ? 0.0f : empty; };
  const StructureCells bridge = valley(deck, slopes);
  const std::vector<std::uint8_t> found = decks_of(bridge, {});
  for (size_t c = 0; c < found.size(); ++c) EXPECT_EQ(found[c], bridge.has_plane(c)) << c % 80 << " " << c / 80;
  // As high as the banks, but it ends in the air on both sides.
  const StructureCells house = valley([](int i, int j) { return std::abs(i - 40) < 8 && std::abs(j - 30) < 8 ? 0.0f : empty; }, slopes);
  for (const std::uint8_t d : decks_of(house, {})) EXPECT_FALSE(d);
}

TEST(Bridges, APlaneAtTheEdgeOfTheDataBesideAValleyIsNone) {
  const auto plane = [](int i, int j) { return std::abs(i - 40) < 15 && std::abs(j - 30) < 4 ? 0.0f : empty; };
  StructureCells c = valley(plane, slopes);
  const auto without_returns = [&c](const std::function<bool(int, int)>& beyond) {
    for (int j = 0; j < 60; ++j)
      for (int i = 0; i < 80; ++i)
        if (beyond(i, j)) c.ground[c.lattice.at(i, j)] = c.low[c.lattice.at(i, j)] = empty;
  };
  // Black water on one side, between its banks: a bridge.
  without_returns([](int i, int j) { return j > 33 && std::abs(i - 40) < 15; });
  const std::vector<std::uint8_t> found = decks_of(c, {});
  for (size_t at = 0; at < found.size(); ++at) EXPECT_EQ(found[at], c.has_plane(at)) << at % 80 << " " << at / 80;
  // The rim of the swath: the banks have no returns either.
  without_returns([](int, int j) { return j > 33; });
  for (const std::uint8_t d : decks_of(c, {})) EXPECT_FALSE(d);
}

TEST(Bridges, CropsThatBeamsPassThroughAreNone) {
  StructureCells c = valley([](int i, int j) { return std::abs(i - 40) < 15 && std::abs(j - 30) < 5 ? 0.0f : empty; },
                            [](int i, int) { return std::abs(i - 40) < 15 ? -1.2f : 0.0f; });
  const std::vector<std::uint8_t> opaque = decks_of(c, {});
  for (size_t at = 0; at < opaque.size(); ++at) EXPECT_EQ(opaque[at], c.has_plane(at)) << at % 80 << " " << at / 80;
  for (size_t at = 0; at < opaque.size(); at += 3)
    if (c.has_plane(at)) c.low[at] = -1.2f;
  for (const std::uint8_t d : decks_of(c, {})) EXPECT_FALSE(d);
}

TEST(Bridges, LongerThanTheLongestIsNotLookedFor) {
  const StructureCells bridge = valley([](int i, int j) { return std::abs(i - 40) < 15 && std::abs(j - 30) < 4 ? 0.0f : empty; }, slopes);
  for (const std::uint8_t d : decks_of(bridge, {.longest = 20.0})) EXPECT_FALSE(d);
}

TEST(Bridges, ARoofOnASlopeThatTouchesTheGroundAboveIsNone) {
  const auto hillside = [](int i, int) { return 0.3f * static_cast<float>(i); };
  const StructureCells house = valley([](int i, int j) { return i >= 30 && i < 40 && std::abs(j - 30) < 6 ? 13.8f : empty; }, hillside);
  for (const std::uint8_t d : decks_of(house, {})) EXPECT_FALSE(d);
}

TEST(Bridges, AMoundThatTheGroundFilterLeftOutIsNone) {
  const auto mound = [](int i, int j) { return std::max(0.0f, 3.0f - 0.14f * static_cast<float>(std::hypot(i - 40.0, j - 30.0))); };
  StructureCells c = valley([&](int i, int j) { return mound(i, j) > 1.0f ? mound(i, j) : empty; }, mound);
  for (size_t at = 0; at < c.height.size(); ++at)
    if (c.has_plane(at)) c.height[at] = c.plane[at];
  for (const std::uint8_t d : decks_of(c, {})) EXPECT_FALSE(d);
}

/// A canal between quays a little below the deck.
StructureCells canal(float water, float deck) {
  StructureCells c = valley([deck](int i, int j) { return std::abs(i - 40) < 8 && std::abs(j - 30) < 4 ? deck : empty; },
                            [&](int i, int) { return std::abs(i - 40) < 8 ? empty : 0.0f; });
  for (int j = 0; j < 60; ++j)
    for (int i = 33; i < 48; ++i) {
      const size_t at = c.lattice.at(i, j);
      if (c.has_plane(at))
        c.height[at] = deck;
      else
        c.low[at] = water;
    }
  return c;
}

TEST(Bridges, ALowDeckOverWaterIsFoundByWhatIsBesideIt) {
  StructureCells over_water = canal(-1.5f, 1.2f);
  for (float& g : over_water.ground)
    if (g == 0.0f) g = 1.0f;
  const std::vector<std::uint8_t> found = decks_of(over_water, {});
  for (size_t c = 0; c < found.size(); ++c) EXPECT_EQ(found[c], over_water.has_plane(c)) << c % 80 << " " << c / 80;
  for (const std::uint8_t d : decks_of(canal(-1.5f, 0.3f), {})) EXPECT_FALSE(d);  // a crop beside ditches
  for (const std::uint8_t d : decks_of(canal(empty, 0.3f), {})) EXPECT_FALSE(d);
}

TEST(Bridges, StairsAtOneEndOfADeckOverBlackWater) {
  StructureCells c = canal(empty, 1.2f);
  for (const std::uint8_t d : decks_of(c, {})) EXPECT_FALSE(d);  // a pontoon: it joins no bank
  for (int j = 0; j < 60; ++j)
    for (int i = 48; i < 80; ++i) c.ground[c.lattice.at(i, j)] = 1.0f;
  const std::vector<std::uint8_t> found = decks_of(c, {});
  for (size_t at = 0; at < found.size(); ++at) EXPECT_EQ(found[at], c.has_plane(at)) << at % 80 << " " << at / 80;
}

TEST(Bridges, ReturnsALittleLowerOnBothSidesAreACropAndNotBlackWater) {
  StructureCells c = canal(0.4f, 1.2f);
  for (int j = 0; j < 60; ++j)
    for (int i = 48; i < 80; ++i) c.ground[c.lattice.at(i, j)] = 1.0f;
  for (const std::uint8_t d : decks_of(c, {})) EXPECT_FALSE(d);
}

}  // namespace
}  // namespace swath::filters
