// SPDX-License-Identifier: GPL-3.0-or-later
// terrain.forest tile by tile: cover, heights and trees do not depend on the tiling.
#include <gtest/gtest.h>

#include <random>
#include <sstream>

#include "tests/stages/tile_work.h"

namespace swath::stages {
namespace {

/// Ground and cone-shaped trees of 10, 15 and 20 m in a row every 10 m, over a square of 90 m; 4 returns per m2.
core::Block wood() {
  core::Block b;
  b.origin = {600000.0, 5300000.0, 0.0};
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(0.0, 90.0);
  for (int k = 0; k < 4 * 90 * 90; ++k) {
    const double x = place(random), y = place(random);
    const int i = static_cast<int>(x / 10.0), j = static_cast<int>(y / 10.0);
    const double top = 10.0 + 5.0 * ((i + j) % 3), r = std::hypot(x - (10.0 * i + 5.0), y - (10.0 * j + 5.0));
    const double height = r < 0.2 * top ? top * (1.0 - r / (0.4 * top)) : 0.0;
    b.x.push_back(x), b.y.push_back(y), b.z.push_back(400.0 + height);
    b.height.push_back(static_cast<float>(height));
    b.classification.push_back(height > 0.0 ? core::point_class::high_vegetation : core::point_class::ground);
  }
  b.flags.assign(b.size(), 0);
  return b;
}

TEST(ForestStage, TheTilingChangesNothing) {
  const core::Block all = wood();
  Work w;
  w.context.origin = all.origin;
  const auto stage = make_stage("terrain.forest");
  const auto run = [&](double tile, const std::string& name) {
    w.context.tile_side = tile;
    w.context.output = w.folder / (name + "/products");
    return w.run_all(*stage, all, w.folder / name);
  };
  const MergeJob whole = run(1000.0, "whole"), parts = run(30.0, "parts");
  EXPECT_EQ(parts.tiles.size(), 12u);
  EXPECT_EQ(io::to_json(parts.findings), io::to_json(whole.findings));
  EXPECT_EQ(test::read_bytes(w.folder / "parts/products/trees.csv"), test::read_bytes(w.folder / "whole/products/trees.csv"));
  EXPECT_EQ(whole.findings.find("trees")->as_int(), 81);
  EXPECT_EQ(parts.tally.of("trees"), 81u);
  // A third of the trees each; the highest return of one lies a little below its top.
  EXPECT_NEAR(whole.findings.find("median_height_m")->as_number(), 15.0, 1.0);
  EXPECT_NEAR(whole.findings.find("p95_height_m")->as_number(), 20.0, 1.0);
  // Crowns are 4, 9 and 16 pi m2 in 300 m2; their edges are half as high as their tops: all of them are of the canopy.
  EXPECT_NEAR(whole.findings.find("cover")->as_number(), 29.0 * M_PI / 300.0, 0.01);
  for (const char* file : {"forest.vrt", "trees.gpkg"}) EXPECT_TRUE(fs::exists(w.folder / "parts/products" / file)) << file;
}

TEST(ForestStage, WithoutTreesThereIsCoverAlone) {
  core::Block all = wood();
  for (size_t p = 0; p < all.size(); ++p) all.height[p] = 0.0F, all.classification[p] = core::point_class::ground;
  Work w;
  w.context.origin = all.origin;
  const MergeJob job = w.run_all(*make_stage("terrain.forest"), all, w.folder / "out");
  EXPECT_EQ(job.findings.find("trees")->as_int(), 0);
  EXPECT_EQ(job.findings.find("cover")->as_number(), 0.0);
  const core::Value* median = job.findings.find("median_height_m");
  EXPECT_FALSE(median && median->is_number());
  EXPECT_EQ(test::read_bytes(w.folder / "products/trees.csv"), "x,y,z,tree,height,crown_area,crown_diameter\n");
}

}  // namespace
}  // namespace swath::stages
