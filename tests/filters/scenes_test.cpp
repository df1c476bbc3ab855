// SPDX-License-Identifier: GPL-3.0-or-later
// Every filter through every scene: counts in = counts out, the same labels for every tiling and every order of the points.
#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "filters/noise.h"
#include "filters/smrf.h"
#include "tests/world/scene.h"

namespace swath::filters {
namespace {

struct Filter {
  std::string name;
  double halo;
  std::function<void(core::Block&, size_t)> run;
};

std::vector<Filter> all_filters() {
  SmrfOptions smrf;
  smrf.window = core::Metres(5.0);  // so that the halo is smaller than the scene
  SmrfOptions net = smrf;
  net.cell = core::Metres(0.7);
  net.window = core::Metres(3.0);
  net.cut = core::Metres(3.0);
  NoiseOptions noise;
  return {{"noise", halo(noise), [noise](core::Block& b, size_t own) { flag_noise(b, own, noise); }},
          {"smrf", halo(smrf), [smrf](core::Block& b, size_t own) { classify_ground_smrf(b, own, smrf); }},
          {"smrf_net", halo(net), [net](core::Block& b, size_t own) { classify_ground_smrf(b, own, net); }}};
}

/// The scene with some noise: low groups, high points, holes.
core::Block spoiled(const test::Scene& s) {
  core::Block b = s.block;
  for (size_t p = 0; p < b.size(); p += 997) b.z[p] += p % 2 == 0 ? 25.0 : -6.0;
  return b;
}

class Scenes : public testing::TestWithParam<std::string> {};

TEST_P(Scenes, LabelsDependNeitherOnTilesNorOnOrder) {
  const test::Scene s = test::make_scene(GetParam());
  const core::Block start = spoiled(s);
  for (const Filter& f : all_filters()) {
    ASSERT_LT(f.halo, 0.5 * test::scene_width) << f.name;
    core::Block whole = start;
    f.run(whole, whole.size());
    ASSERT_EQ(whole.size(), start.size());
    EXPECT_EQ(whole.z, start.z);
    const core::Block tiles = test::run_tiled(start, 50.0, f.halo, f.run);
    EXPECT_EQ(tiles.classification, whole.classification) << f.name;
    EXPECT_EQ(tiles.flags, whole.flags) << f.name;
    const core::Block others = test::run_tiled(start, 37.3, f.halo, f.run);
    EXPECT_EQ(others.classification, whole.classification) << f.name;
    EXPECT_EQ(others.flags, whole.flags) << f.name;

    std::vector<std::uint32_t> rows;
    core::Block mixed = test::shuffled(start, 11, rows);
    f.run(mixed, mixed.size());
    const core::Block expected = core::select(whole, rows);
    EXPECT_EQ(mixed.classification, expected.classification) << f.name;
    EXPECT_EQ(mixed.flags, expected.flags) << f.name;
  }
}

TEST(ScenesTogether, WithoutTheHaloLabelsDoDependOnTiles) {
  for (const Filter& f : all_filters()) {
    size_t different = 0;
    for (const char* name : {"town", "forest"}) {
      const core::Block start = spoiled(test::make_scene(name));
      core::Block whole = start;
      f.run(whole, whole.size());
      const core::Block tiles = test::run_tiled(start, 50.0, 0.0, f.run);
      for (size_t p = 0; p < whole.size(); ++p) different += tiles.classification[p] != whole.classification[p];
    }
    EXPECT_GT(different, 0u) << f.name;
  }
}

TEST_P(Scenes, NoiseFilterLeavesCleanScenesAlone) {
  test::Scene s = test::make_scene(GetParam());
  const NoiseCounts n = flag_noise(s.block, s.block.size(), {});
  constexpr double bearable = 0.001;  // of the points
  EXPECT_LE(static_cast<double>(n.low_noise + n.high_noise), bearable * static_cast<double>(s.block.size()));
}

INSTANTIATE_TEST_SUITE_P(Zoo, Scenes, testing::ValuesIn(test::scene_names()), [](const auto& tested) { return tested.param; });

}  // namespace
}  // namespace swath::filters
