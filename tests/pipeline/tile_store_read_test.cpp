// SPDX-License-Identifier: GPL-3.0-or-later
// What lies around tiles: read, thinned, and counted beforehand.
#include <limits>
#include <random>

#include "pipeline/tile_store.h"
#include "pipeline/work/store_file.h"
#include "tests/world/support.h"

namespace swath::pipeline {
namespace {

using core::Block;
using core::Column;

/// Points of one strip over two tiles of 100 m, side by side.
struct TwoTiles {
  test::TemporaryFolder folder;
  TileStore store{folder / "strips", 100.0, {0, 0, 0}};
  Block all;

  explicit TwoTiles(std::uint32_t count) {
    StripWriter writer(folder / "strips/strip_1", 100.0, 1 << 20);
    std::mt19937 random(3);
    std::uniform_real_distribution<double> east(10.0, 190.0), north(0.0, 100.0);
    for (std::uint32_t from = 0; from < count; from += 40000) {
      Block b;
      for (std::uint32_t i = 0; i < std::min(count - from, 40000u); ++i)
        b.x.push_back(east(random)), b.y.push_back(north(random)), b.z.push_back(i);
      b.classification.assign(b.size(), 1);
      writer.write(b);
      core::append(all, b);
    }
    writer.commit("");
    store.open({"strip_1"});
  }
};

TEST(TileStoreAround, PointsAroundAreThinnedWhileTheyAreReadAndWithTheirOverlays) {
  TwoTiles s(1200000);
  TileStore& store = s.store;
  const test::TemporaryFolder& folder = s.folder;
  const TileKey key{0, 0}, neighbour{1, 0};
  ASSERT_GT(store.tiles().at(neighbour), 2 * TileStore::thinned_at_once);
  Block whole = store.read(neighbour, {Column::classification});
  for (size_t i = 0; i < whole.size(); ++i) whole.classification[i] = static_cast<std::uint8_t>(i % 7);
  std::filesystem::create_directories(folder / "overlay");
  store.write_overlay(folder / "overlay", neighbour, whole, 0, whole.size(), {Column::classification});
  const Block own_points = store.read(key, {Column::classification});
  store.write_overlay(folder / "overlay", key, own_points, 0, own_points.size(), {Column::classification});
  store.add_overlay(folder / "overlay", {Column::classification});
  int times = 0;
  size_t own = 0, largest = 0;
  const Block b = store.read_with_halo({key}, 60.0, {Column::classification}, own, [&](Block& part) {
    ++times;
    largest = std::max(largest, part.size());
    std::vector<std::uint32_t> rows;
    for (std::uint32_t i = 0; i < part.size(); ++i)
      if (part.classification[i] == 3) rows.push_back(i);
    part = core::select(part, rows);
  });
  EXPECT_GT(times, 1);
  std::vector<double> expected;
  for (size_t i = 0; i < whole.size(); ++i)
    if (whole.x[i] < 160.0 && whole.classification[i] == 3) expected.push_back(whole.x[i]);
  ASSERT_EQ(b.size() - own, expected.size());
  EXPECT_TRUE(std::equal(expected.begin(), expected.end(), b.x.begin() + static_cast<std::ptrdiff_t>(own)));
  EXPECT_LE(largest, expected.size() + TileStore::thinned_at_once + chunk_rows);
  EXPECT_EQ(own, own_points.size());
}

TEST(TileStoreAround, KnowsHowFarItsPointsExtend) {
  const TwoTiles s(1000);
  const stages::Box all = s.store.extent_in({-500.0, -500.0, 500.0, 500.0});
  for (size_t i = 0; i < s.all.size(); ++i) EXPECT_TRUE(all.grown(1e-6).holds(s.all.x[i], s.all.y[i]));
  EXPECT_LE(all.area(), 180.0 * 100.0);
  EXPECT_GT(all.area(), 170.0 * 90.0);
  EXPECT_EQ(s.store.extent_in({5000.0, 5000.0, 5100.0, 5100.0}).area(), 0.0);
  const stages::Box cut = s.store.extent_in({50.0, 20.0, 80.0, 40.0});
  EXPECT_EQ(cut.x0, 50.0);
  EXPECT_EQ(cut.y1, 40.0);
}

TEST(TileStoreAround, CountsWhatThinningLeavesAtMost) {
  const TwoTiles s(20000);
  const double near = 20.0, halo = 60.0;
  size_t between = 0;
  for (const double x : s.all.x) between += x >= 120.0 && x < 160.0;
  EXPECT_GE(s.store.left_around({{0, 0}}, near, halo, std::numeric_limits<double>::infinity()), between);
  // One for each square metre between them, cells at the rim with it.
  EXPECT_GE(s.store.left_around({{0, 0}}, near, halo, 1.0), 40u * 99u);
  EXPECT_LE(s.store.left_around({{0, 0}}, near, halo, 1.0), 40u * 102u);
  EXPECT_EQ(s.store.left_around({{0, 0}, {1, 0}}, near, halo, 1.0), 0u);
}

}  // namespace
}  // namespace swath::pipeline
