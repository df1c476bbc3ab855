// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/classes/classify.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <limits>

#include "core/config/option_visitors.h"
#include "tests/world/scene.h"

namespace swath::filters {
namespace {

namespace cls = core::point_class;

/// The scene after a perfect ground filter: ground labelled, heights from the terrain itself.
core::Block prepared(const test::Scene& s) {
  core::Block b = s.block;
  core::add_columns(b, {core::Column::height});
  for (size_t p = 0; p < b.size(); ++p) {
    b.classification[p] = s.truth[p] == cls::ground ? cls::ground : cls::unassigned;
    b.height[p] = static_cast<float>(b.z[p] - s.terrain(b.x[p], b.y[p]));
  }
  return b;
}

struct Match {
  double recall, precision;
};
Match match(const core::Block& b, const std::vector<std::uint8_t>& truth, std::uint8_t kind) {
  double both = 0, said = 0, is = 0;
  for (size_t p = 0; p < b.size(); ++p) {
    both += b.classification[p] == kind && truth[p] == kind;
    said += b.classification[p] == kind;
    is += truth[p] == kind;
  }
  return {both / std::max(is, 1.0), both / std::max(said, 1.0)};
}

TEST(Classify, TownForestAndBridgeComeOutAsTheyAre) {
  struct Bar {
    const char* scene;
    std::uint8_t kind;
  };
  constexpr double good = 0.97;  // of recall and precision, at one pulse per square metre
  for (const Bar& bar : {Bar{"town", cls::building}, Bar{"forest", cls::high_vegetation}, Bar{"bridge", cls::bridge_deck}}) {
    const test::Scene s = test::make_scene(bar.scene);
    core::Block b = prepared(s);
    classify(b, b.size(), {});
    const Match m = match(b, s.truth, bar.kind);
    EXPECT_GE(m.recall, good) << bar.scene;
    EXPECT_GE(m.precision, good) << bar.scene;
    for (size_t p = 0; p < b.size(); ++p) EXPECT_EQ(b.classification[p] == cls::ground, s.truth[p] == cls::ground);
  }
}

TEST(Classify, ThreadsWithinATileChangeNothing) {
  for (const char* scene : {"town", "forest", "bridge"}) {
    std::vector<std::uint8_t> by_one;
    for (const size_t threads : {1u, 2u, 5u}) {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
      core::Block b = prepared(test::make_scene(scene));
      classify(b, b.size(), {});
      if (threads == 1) by_one = b.classification;
      EXPECT_EQ(b.classification, by_one) << scene << ", " << threads << " threads";
    }
  }
}

TEST(Classify, ADeckThatIsGroundBecomesABridgeAndTheBankStays) {
  test::Scene s = test::make_scene("flat");
  core::Block b = prepared(s);
  std::vector<std::uint32_t> rows;  // a canal without returns, with a road across it
  for (std::uint32_t p = 0; p < b.size(); ++p)
    if (std::abs(b.x[p] - 100.0) > 8.0 || std::abs(b.y[p] - 80.0) < 6.0) rows.push_back(p);
  b = core::select(b, rows);
  const ClassifyCounts n = classify(b, b.size(), {});
  double found = 0, all = 0;
  for (size_t p = 0; p < b.size(); ++p) {
    const bool on = std::abs(b.x[p] - 100.0) < 8.0;
    all += on, found += on && b.classification[p] == cls::bridge_deck;
    if (std::abs(b.x[p] - 100.0) > 12.0) {
      EXPECT_EQ(b.classification[p], cls::ground) << b.x[p] << " " << b.y[p];
    }
  }
  EXPECT_GE(found, 0.8 * all);
  EXPECT_EQ(n.kept + n.bridge_deck, b.size());
  ClassifyOptions o;
  o.bridge_length = core::Metres(0.0);
  b.classification.assign(b.size(), cls::ground);
  EXPECT_EQ(classify(b, b.size(), o).bridge_deck, 0u);
}

TEST(Classify, DecksDoNotDependOnTiles) {
  const core::Block start = prepared(test::make_scene("bridge"));
  core::Block whole = start;
  EXPECT_GT(classify(whole, whole.size(), {}).bridge_deck, 100u);
  const auto filter = [](core::Block& b, size_t own) { classify(b, own, {}); };
  EXPECT_EQ(test::run_tiled(start, 73.0, halo(ClassifyOptions{}), filter).classification, whole.classification);
}

TEST(Classify, VegetationByHeight) {
  test::Scene s = test::make_scene("flat");
  core::Block b = prepared(s);
  const float heights[] = {0.3f, 0.5f, 1.9f, 2.0f, 15.0f, -0.2f, std::numeric_limits<float>::quiet_NaN()};
  const std::uint8_t expected[] = {3, 4, 4, 5, 5, 1, 1};
  for (size_t k = 0; k < 7; ++k) {
    const size_t p = 200 * 20 * (k + 1) + 50;
    b.classification[p] = cls::unassigned;
    b.height[p] = heights[k];
    if (std::isfinite(heights[k])) b.z[p] = 100.0 + static_cast<double>(heights[k]);
  }
  const ClassifyCounts n = classify(b, b.size(), {});
  for (size_t k = 0; k < 7; ++k) EXPECT_EQ(b.classification[200 * 20 * (k + 1) + 50], expected[k]) << k;
  EXPECT_EQ(n.low_vegetation, 1u);
  EXPECT_EQ(n.medium_vegetation, 2u);
  EXPECT_EQ(n.high_vegetation, 2u);
  EXPECT_EQ(n.unassigned, 2u);
  EXPECT_EQ(n.kept, b.size() - 7);
}

TEST(Classify, SmallOrLowPlanesAreNoBuildings) {
  test::Scene s = test::make_scene("flat");
  for (size_t p = 0; p < s.block.size(); ++p) {
    const double x = s.block.x[p], y = s.block.y[p];
    const double top = std::abs(x - 60.0) < 4.0 && std::abs(y - 60.0) < 4.0    ? 1.6  // a container yard: low
                       : std::abs(x - 120.0) < 4.0 && std::abs(y - 60.0) < 4.0 ? 4.0  // a house
                                                                               : 0.0;
    if (top == 0.0) continue;
    s.block.z[p] += top;
    s.truth[p] = top > 2.0 ? cls::building : cls::unassigned;
  }
  core::Block b = prepared(s);
  classify(b, b.size(), {});
  EXPECT_EQ(match(b, s.truth, cls::building).precision, 1.0);
  EXPECT_GE(match(b, s.truth, cls::building).recall, 0.95);
  b = prepared(s);
  ClassifyOptions o;
  o.building_side = core::Metres(12.0);
  const ClassifyCounts n = classify(b, b.size(), o);
  EXPECT_EQ(n.building, 0u);
  EXPECT_EQ(n.high_vegetation, 0u);  // smooth: no vegetation either
}

TEST(Classify, ReturnsScatteredBelowTheGroundAreLowNoiseAndAPitIsNot) {
  test::Scene s = test::make_scene("flat");
  core::Block b = prepared(s);
  size_t noise = 0, pit = 0;
  std::vector<std::uint8_t> expected(b.size(), 0);
  for (size_t p = 0; p < b.size(); ++p) {
    const bool group = std::hypot(b.x[p] - 50.0, b.y[p] - 50.0) < 2.0 && p % 2 == 0;      // echoes on detours, among the ground's
    const bool deep = std::abs(b.x[p] - 120.0) < 12.0 && std::abs(b.y[p] - 60.0) < 12.0;  // an excavation that the ground filter refused
    if (!group && !deep) continue;
    b.z[p] -= 3.0, b.height[p] -= 3.0f, b.classification[p] = cls::unassigned;
    expected[p] = group ? cls::low_noise : cls::unassigned;
    noise += group, pit += deep;
  }
  ASSERT_GT(noise, 3u);
  const ClassifyCounts n = classify(b, b.size(), {});
  size_t found = 0, taken = 0;
  for (size_t p = 0; p < b.size(); ++p) {
    found += expected[p] == cls::low_noise && b.classification[p] == cls::low_noise && (b.flags[p] & core::flag::low_point);
    taken += expected[p] == cls::unassigned && b.classification[p] == cls::low_noise;
  }
  EXPECT_GE(found, noise - 1);
  EXPECT_LE(static_cast<double>(taken), 0.2 * static_cast<double>(pit));  // at its edge
  EXPECT_EQ(n.low_noise, found + taken);
}

TEST(Classify, ShallowEchoesAmongGroundAreLowNoiseAndADitchIsNot) {
  const test::Scene s = test::make_scene("flat");
  core::Block b = prepared(s);
  size_t echoes = 0, ditch = 0;
  const auto is_echo = [&](size_t p) { return p % 97 == 0 && b.x[p] < 90.0; };
  const auto is_ditch = [&](size_t p) { return std::abs(b.x[p] - 120.0) < 1.5; };  // 3 m wide, refused by the ground filter
  for (size_t p = 0; p < b.size(); ++p) {
    if (!is_echo(p) && !is_ditch(p)) continue;
    b.z[p] -= 0.6, b.height[p] -= 0.6f, b.classification[p] = cls::unassigned;
    echoes += is_echo(p), ditch += is_ditch(p);
  }
  ASSERT_GT(echoes, 50u);
  classify(b, b.size(), {});
  size_t found = 0, taken = 0;
  for (size_t p = 0; p < b.size(); ++p) {
    found += is_echo(p) && b.classification[p] == cls::low_noise;
    taken += is_ditch(p) && b.classification[p] == cls::low_noise;
  }
  EXPECT_GE(static_cast<double>(found), 0.95 * static_cast<double>(echoes));
  EXPECT_LE(static_cast<double>(taken), 0.2 * static_cast<double>(ditch));
}

TEST(Classify, LowNoiseIsFoundWhereItTookTheGroundAroundFromTheFilter) {
  const test::Scene s = test::make_scene("flat");
  core::Block b = prepared(s);
  size_t group = 0, found = 0;
  const auto is_low = [&](size_t p) { return std::hypot(b.x[p] - 50.0, b.y[p] - 50.0) < 3.0 && p % 2 == 0; };
  for (size_t p = 0; p < b.size(); ++p) {
    if (std::hypot(b.x[p] - 50.0, b.y[p] - 50.0) < 6.0) b.classification[p] = cls::unassigned;
    if (is_low(p)) b.z[p] -= 4.0, b.height[p] -= 4.0f, ++group;
  }
  ASSERT_GT(group, 8u);
  classify(b, b.size(), {});
  for (size_t p = 0; p < b.size(); ++p) {
    found += is_low(p) && b.classification[p] == cls::low_noise;
    EXPECT_TRUE(is_low(p) || b.classification[p] != cls::low_noise);
  }
  EXPECT_GE(static_cast<double>(found), 0.9 * static_cast<double>(group));
}

TEST(Classify, AWireOverAFieldAndNoiseWaterAndHaloStay) {
  test::Scene s = test::make_scene("flat");
  const size_t before = s.block.size();
  for (double x = 5.0; x < 195.0; x += 1.1) {
    core::resize(s.block, s.block.size() + 1);
    s.block.x.back() = x, s.block.y.back() = 80.0 + 0.2 * x, s.block.z.back() = 115.0;
    s.block.return_number.back() = s.block.return_count.back() = 1;
    s.truth.push_back(cls::wire);
  }
  core::Block b = prepared(s);
  b.classification[0] = cls::high_noise;
  b.classification[1] = cls::water;
  b.classification[before + 50] = cls::high_noise;  // found alone in space
  b.flags[before + 50] = core::flag::isolated;
  const size_t own = b.size() - 2;
  classify(b, own, {});
  for (size_t p = before; p < own; ++p) EXPECT_EQ(b.classification[p], cls::wire) << p;
  EXPECT_EQ(b.flags[before + 50], 0);
  EXPECT_EQ(b.classification[0], cls::high_noise);
  EXPECT_EQ(b.classification[1], cls::water);
  EXPECT_EQ(b.classification[own], cls::unassigned);
}

TEST(Classify, OptionsAreCheckedAgainstOneAnother) {
  ClassifyOptions o;
  std::vector<core::Fault> faults;
  core::Value table = core::Value::object();
  table["high_vegetation"] = "0.1 m";
  core::read_options(core::described(o), table, "", faults);
  ASSERT_EQ(faults.size(), 1u);
  EXPECT_EQ(faults[0].what, "high_vegetation must not be less than medium_vegetation");
}

}  // namespace
}  // namespace swath::filters
