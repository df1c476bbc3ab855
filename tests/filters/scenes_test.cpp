// SPDX-License-Identifier: GPL-3.0-or-later
// Every filter through every scene: counts in = counts out, the same labels for every tiling and every order of the points. filters.ground
// has a halo as wide as a scene and goes through several that lie side by side (ground_test).
#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "filters/classes/classify.h"
#include "filters/ground/csf.h"
#include "filters/ground/ground_ptd.h"
#include "filters/ground/pmf.h"
#include "filters/ground/robust.h"
#include "filters/ground/smrf.h"
#include "filters/noise/noise.h"
#include "filters/noise/outlier.h"
#include "filters/noise/visibility.h"
#include "tests/world/scene.h"

namespace swath::filters {
namespace {

struct Filter {
  std::string name;
  double halo;
  std::function<void(core::Block&, size_t)> run;
};

/// Beams of up to 31 deg from a scanner that flies along y.
void see(core::Block& b, size_t own, const VisibilityOptions& o) {
  std::vector<Eigen::Vector3d> scanner;
  for (size_t p = 0; p < b.size(); ++p) scanner.emplace_back(-100.0, b.y[p], 600.0);
  Visibility rasters;
  trace_visibility(b, own, scanner, {}, o, rasters);
}

/// Points above 101 m count as off the ground; heights from there.
void class_above(core::Block& b, size_t own, const ClassifyOptions& o) {
  core::add_columns(b, {core::Column::height});
  for (size_t p = 0; p < b.size(); ++p) {
    const double level = 97.0 + 0.04 * b.x[p];
    b.height[p] = static_cast<float>(b.z[p] - level);
    if (b.classification[p] == core::point_class::never_classified && b.z[p] < level + 3.5) b.classification[p] = core::point_class::ground;
  }
  classify(b, own, o);
}

std::vector<Filter> all_filters() {
  SmrfOptions smrf;
  smrf.window = core::Metres(5.0);  // so that the halo is smaller than the scene
  SmrfOptions net = smrf;
  net.cell = core::Metres(0.7);
  net.window = core::Metres(3.0);
  net.cut = core::Metres(3.0);
  NoiseOptions noise;
  OutlierOptions outlier;
  outlier.multiplier = 2.0;  // so that many points are near the threshold
  outlier.min_distance = core::Metres(0.5);
  VisibilityOptions visibility;
  visibility.reach = core::Metres(20.0);
  ClassifyOptions classes;
  classes.bridge_length = core::Metres(12.0);  // decks of full length: classify_test.cpp
  classes.building_side = core::Metres(2.0);
  PtdOptions ptd;
  ptd.building = core::Metres(10.0);
  CsfOptions csf;
  csf.span = core::Metres(15.0);
  csf.iterations = 100;
  RobustOptions robust;
  robust.levels = 2;
  PmfOptions pmf;
  pmf.max_window_size = core::Metres(9.0);
  return {{"noise", halo(noise), [noise](core::Block& b, size_t own) { flag_noise(b, own, noise); }},
          {"outlier", halo(outlier), [outlier](core::Block& b, size_t own) { flag_outliers(b, own, outlier); }},
          {"visibility", halo(visibility), [visibility](core::Block& b, size_t own) { see(b, own, visibility); }},
          {"classify", halo(classes), [classes](core::Block& b, size_t own) { class_above(b, own, classes); }},
          {"smrf", halo(smrf), [smrf](core::Block& b, size_t own) { classify_ground_smrf(b, own, smrf); }},
          {"smrf_net", halo(net), [net](core::Block& b, size_t own) { classify_ground_smrf(b, own, net); }},
          {"ptd", halo(ptd), [ptd](core::Block& b, size_t own) { classify_ground_ptd(b, own, ptd); }},
          {"csf", halo(csf), [csf](core::Block& b, size_t own) { classify_ground_csf(b, own, csf); }},
          {"robust", halo(robust), [robust](core::Block& b, size_t own) { classify_ground_robust(b, own, robust); }},
          {"pmf", halo(pmf), [pmf](core::Block& b, size_t own) { classify_ground_pmf(b, own, pmf); }}};
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
    const double tile = std::min(50.0, test::scene_width - f.halo - 1.0);
    ASSERT_GT(tile, 15.0) << f.name;
    core::Block whole = start;
    f.run(whole, whole.size());
    ASSERT_EQ(whole.size(), start.size());
    EXPECT_EQ(whole.z, start.z);
    const core::Block tiles = test::run_tiled(start, tile, f.halo, f.run);
    EXPECT_EQ(tiles.classification, whole.classification) << f.name;
    EXPECT_EQ(tiles.flags, whole.flags) << f.name;
    if (tile == 50.0) {
      const core::Block others = test::run_tiled(start, 37.3, f.halo, f.run);
      EXPECT_EQ(others.classification, whole.classification) << f.name;
      EXPECT_EQ(others.flags, whole.flags) << f.name;
    }

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
