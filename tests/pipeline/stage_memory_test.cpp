// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/stage_memory.h"

#include <random>

#include "stages/registry.h"
#include "tests/world/support.h"

namespace swath::pipeline {
namespace {

constexpr double side = 100.0;

/// Three by three tiles, the one in the middle ten times as dense in one corner.
struct Dense {
  test::TemporaryFolder folder;
  TileStore store{folder / "strips", side, {0, 0, 0}};
  Dense() {
    core::Block b;
    std::mt19937 random(1);
    std::uniform_real_distribution<double> all(-side, 2 * side), corner(0.0, 20.0);
    for (int i = 0; i < 90000; ++i) b.x.push_back(all(random)), b.y.push_back(all(random)), b.z.push_back(0.0);
    for (int i = 0; i < 20000; ++i) b.x.push_back(corner(random)), b.y.push_back(corner(random)), b.z.push_back(0.0);
    core::add_columns(b, {core::Column::classification, core::Column::flags, core::Column::return_number, core::Column::return_count});
    StripWriter writer(folder / "strips/strip_1", side, 1 << 20);
    writer.write(b);
    writer.commit("");
    store.open({"strip_1"});
  }
};

TEST(StageMemory, ATileThatDoesNotFitIsCutUntilItDoesAndItsPartsHoldWhatWasCounted) {
  const Dense d;
  const io::Survey survey;
  stages::Context context{survey};
  context.tile_side = side;
  const auto stage = stages::make_stage("filters.noise");
  const StageMemory memory(d.store, *stage, context);
  SquareCounts counts(d.store);
  const TileGroup whole = memory.of({{0, 0}});
  EXPECT_EQ(memory.cut(whole, whole.bytes, counts).parts, 1);
  const TileGroup cut = memory.cut(whole, whole.bytes * 8 / 10, counts);
  ASSERT_GT(cut.parts, 1);
  EXPECT_LE(cut.bytes, whole.bytes * 8 / 10);
  EXPECT_EQ(cut.own, whole.own);
  for (int k = 0; k < cut.parts * cut.parts; ++k) {
    std::vector<std::uint32_t> rows;
    const TilePart part{{0, 0}, cut.parts, k % cut.parts, k / cut.parts};
    EXPECT_LE(d.store.read_part(part, stage->halo(), {}, rows).size(), cut.with_halo);
  }
  // What nothing helps with is said as the least.
  const TileGroup least = memory.cut(whole, 1, counts);
  EXPECT_GT(least.bytes, 1u);
  EXPECT_LE(least.bytes, cut.bytes);
}

TEST(StageMemory, RastersAroundThePointsReachNoFartherThanThey) {
  const Dense d;
  const io::Survey survey;
  stages::Context context{survey};
  context.tile_side = side;
  const auto stage = stages::make_stage("filters.ground");
  const StageMemory memory(d.store, *stage, context);
  const TileGroup whole = memory.of({{0, 0}});
  EXPECT_EQ(whole.own, d.store.tiles().at({0, 0}));
  // 52 bytes per square metre of the halo alone would be more than this.
  const double across = side + 2.0 * stage->halo();
  EXPECT_LT(static_cast<double>(whole.bytes), 52.0 * across * across);
}

/// A tile without neighbours has all points inside the border that the model's triangles come from.
TEST(StageMemory, AtTheEdgeOfASurveyEveryPointOfTheTileCounts) {
  const test::TemporaryFolder folder;
  core::Block b;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> inside(0.0, side);
  for (int i = 0; i < 90000; ++i) b.x.push_back(inside(random)), b.y.push_back(inside(random)), b.z.push_back(0.0);
  core::add_columns(b, {core::Column::classification, core::Column::flags});
  StripWriter writer(folder / "strips/strip_1", side, 1 << 20);
  writer.write(b);
  writer.commit("");
  TileStore store(folder / "strips", side, {0, 0, 0});
  store.open({"strip_1"});
  const io::Survey survey;
  stages::Context context{survey};
  context.tile_side = side;
  const auto stage = stages::make_stage("terrain.dtm");
  const StageMemory memory(store, *stage, context);
  EXPECT_GE(static_cast<double>(memory.of({{0, 0}}).bytes), stage->memory(context).bytes_per_point * 90000.0);
}

TEST(StageMemory, AStageThatDoesNotDivideTilesIsNotCut) {
  const Dense d;
  const io::Survey survey;
  stages::Context context{survey};
  context.tile_side = side;
  const auto stage = stages::make_stage("terrain.penetration");
  const StageMemory memory(d.store, *stage, context);
  SquareCounts counts(d.store);
  EXPECT_EQ(memory.cut(memory.of({{0, 0}}), 1, counts).parts, 1);
}

}  // namespace
}  // namespace swath::pipeline
