// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/tile_groups.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

namespace swath::pipeline {
namespace {

constexpr std::uint64_t per_tile = 1000, halo = 300;  // points of a tile, and along each side of a tile

TileGroup measured(std::vector<TileKey> tiles) {
  std::sort(tiles.begin(), tiles.end());
  const TileBox box(tiles);
  TileGroup g{tiles, per_tile * tiles.size(), 0, 0};
  g.with_halo = g.own + 2 * halo * static_cast<std::uint64_t>(box.across() + box.up());
  g.bytes = 10 * g.with_halo;
  return g;
}

std::vector<TileKey> rectangle(int across, int up) {
  std::vector<TileKey> tiles;
  for (int i = 0; i < across; ++i)
    for (int j = 0; j < up; ++j) tiles.push_back({i - 2, j});
  return tiles;
}

void expect_all_once(const std::vector<TileGroup>& groups, const std::vector<TileKey>& tiles) {
  std::map<TileKey, int> seen;
  for (const TileGroup& g : groups) {
    const TileBox box(g.tiles);
    for (const TileKey k : tiles)
      EXPECT_EQ(box.holds(k), std::find(g.tiles.begin(), g.tiles.end(), k) != g.tiles.end());  // nothing of others in its box
    for (const TileKey k : g.tiles) ++seen[k];
  }
  EXPECT_EQ(seen.size(), tiles.size());
  for (const auto& [k, n] : seen) EXPECT_EQ(n, 1);
}

TEST(TileGroups, OneForEachThreadWhereTheyBalance) {
  const std::vector<TileKey> tiles = rectangle(4, 2);
  const auto groups = joined_tiles(tiles, 2, 1'000'000'000, measured);
  ASSERT_EQ(groups.size(), 2u);
  expect_all_once(groups, tiles);
  EXPECT_EQ(groups[0].tiles.size(), 4u);
  EXPECT_EQ(TileBox(groups[0].tiles).across(), 2);  // cut across the longer side
  EXPECT_EQ(joined_tiles(tiles, 1, 1'000'000'000, measured).size(), 1u);
}

TEST(TileGroups, MemoryBoundsThem) {
  const std::vector<TileKey> tiles = rectangle(8, 8);
  for (const std::uint64_t budget : {400'000u, 200'000u, 100'000u, 80'000u}) {
    const auto groups = joined_tiles(tiles, 2, budget, measured);
    expect_all_once(groups, tiles);
    std::vector<std::uint64_t> bytes;
    for (const TileGroup& g : groups) bytes.push_back(g.bytes);
    std::sort(bytes.rbegin(), bytes.rend());
    EXPECT_LE(bytes[0] + bytes[1], budget);
    EXPECT_LT(groups.size(), tiles.size());
  }
  EXPECT_EQ(joined_tiles(tiles, 2, 1000, measured).size(), tiles.size());  // nothing fits: the smallest there are
  EXPECT_EQ(single_tiles(tiles, measured).size(), tiles.size());
  EXPECT_TRUE(joined_tiles({}, 2, 1000, measured).empty());
}

TEST(TileGroups, NoneIsTooLargeAndTheSameComeAgain) {
  const auto dense = [](std::vector<TileKey> tiles) {
    TileGroup g = measured(std::move(tiles));
    g.own *= 5000, g.with_halo *= 5000;
    return g;
  };
  const std::vector<TileKey> tiles = rectangle(6, 5);
  const auto groups = joined_tiles(tiles, 1, 1'000'000'000, dense);
  expect_all_once(groups, tiles);
  std::vector<TileBox> boxes;
  for (const TileGroup& g : groups) {
    EXPECT_LE(g.with_halo, most_points);
    boxes.emplace_back(g.tiles);
  }
  EXPECT_GT(groups.size(), 4u);
  const auto again = grouped_tiles(tiles, boxes, dense);
  ASSERT_EQ(again.size(), groups.size());
  for (size_t k = 0; k < groups.size(); ++k) EXPECT_EQ(again[k].tiles, groups[k].tiles);
}

TEST(TileGroups, TilesWithGaps) {
  std::vector<TileKey> tiles;
  for (int k = 0; k < 12; ++k) tiles.push_back({k, 3 * k});  // a survey's line across the lattice
  tiles.push_back({0, 30});
  const auto groups = joined_tiles(tiles, 3, 100'000, measured);
  expect_all_once(groups, tiles);
  EXPECT_LT(groups.size(), tiles.size());
}

}  // namespace
}  // namespace swath::pipeline
