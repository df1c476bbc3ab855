// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/ground/ground.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <numeric>
#include <random>
#include <vector>

#include "filters/bins.h"
#include "tests/filters/ground_truth.h"

namespace swath::filters {
namespace {

GroundCounts run(core::Block& b, size_t own) { return classify_ground(b, own, {}); }

struct Sample {
  const char* name;
  double total_bar;  ///< %, of PDAL's filters.smrf with its defaults
};
class GroundIsprs : public testing::TestWithParam<Sample> {};

TEST_P(GroundIsprs, TotalErrorWithTheDefaultsIsWithinTheBar) {
  SWATH_SHARED_OR_SKIP(folder, "data/isprs");
  test::expect_sample_within(folder, GetParam().name, GetParam().total_bar, run);
}

INSTANTIATE_TEST_SUITE_P(Samples, GroundIsprs,
                         testing::Values(Sample{"samp11", 9.9}, Sample{"samp21", 2.5}, Sample{"samp24", 4.1}, Sample{"samp41", 6.5},
                                         Sample{"samp52", 4.5}, Sample{"samp54", 7.0}, Sample{"samp71", 3.7}),
                         [](const auto& tested) { return std::string(tested.param.name); });

TEST(Ground, MadeScenesComeOutNearlyWhole) {
  test::expect_within({{"flat", 0.2, 0},
                       {"slope", 0.2, 0},
                       {"town", 0.3, 0.3},
                       {"forest", 2.0, 0.5},
                       {"water", 0.2, 0},
                       {"void", 0.2, 0},
                       {"strip_edge", 0.2, 0},
                       {"scarp", 0.5, 0},
                       {"bridge", 0.5, 3.0}},
                      run);
}

/// A hall of 80 m x 40 m around a courtyard of 20 m x 12 m.
test::Scene hall() {
  test::Scene s = test::make_scene("flat");
  for (size_t p = 0; p < s.block.size(); ++p) {
    const double u = std::abs(s.block.x[p] - 100.0), v = std::abs(s.block.y[p] - 80.0);
    if (u > 40.0 || v > 20.0 || (u < 10.0 && v < 6.0)) continue;
    s.block.z[p] += 9.0;
    s.truth[p] = core::point_class::building;
  }
  return s;
}

TEST(Ground, AHallIsTakenOffAndItsCourtyardKept) {
  test::Scene s = hall();
  classify_ground(s.block, s.block.size(), {});
  const test::GroundErrors e = test::ground_errors(s.block, s.truth);
  EXPECT_LT(e.type_2(), 0.1);
  EXPECT_LT(e.type_1(), 0.3);
  size_t kept = 0, yard = 0;
  for (size_t p = 0; p < s.block.size(); ++p)
    if (std::abs(s.block.x[p] - 100.0) < 9.0 && std::abs(s.block.y[p] - 80.0) < 5.0)
      ++yard, kept += s.block.classification[p] == core::point_class::ground;
  EXPECT_GT(kept, yard * 97 / 100);
}

TEST(Ground, LowPointsAreNotGroundNorDoTheyTakeTheirSurroundingsAlong) {
  test::Scene s = test::make_scene("slope");
  size_t low = 0;
  for (size_t p = 0; p < s.block.size(); p += 211) {
    s.block.z[p] -= 0.7 + 0.05 * static_cast<double>(p % 300);
    s.truth[p] = core::point_class::low_noise;
    ++low;
  }
  classify_ground(s.block, s.block.size(), {});
  const test::GroundErrors e = test::ground_errors(s.block, s.truth);
  EXPECT_EQ(e.object, static_cast<double>(low));
  constexpr double bearable = 0.01;  // of the low points
  EXPECT_LE(e.taken_object, bearable * e.object);
  EXPECT_LT(e.type_1(), 0.3);
}

TEST(Ground, AReturnWithoutAnotherFarAroundIsNotJudged) {
  core::Block b;
  core::add_columns(b, {core::Column::flags});
  // Seven over 40 km2, and a hundred that lie together.
  for (int k = 0; k < 7; ++k) b.x.push_back(900.0 * k), b.y.push_back(1000.0 * (k % 3)), b.z.push_back(100.0);
  core::Block wide = b;
  core::resize(wide, wide.x.size());
  const GroundChances none = classify_ground(wide, wide.size(), {});
  EXPECT_EQ(none.ground, 0u);
  EXPECT_EQ(none.no_surface, 7u);
  for (int k = 0; k < 100; ++k) b.x.push_back(50.0 + k % 10), b.y.push_back(50.0 + k / 10), b.z.push_back(100.0 + 0.01 * (k % 3));
  core::resize(b, b.x.size());
  const GroundChances some = classify_ground(b, b.size(), {});
  EXPECT_EQ(some.no_surface, 7u);
  EXPECT_EQ(some.ground, 100u);
}

TEST(Ground, FewReturnsFarApartAreJudgedAsInTheWhole) {
  // Four groups of five with a low and a high return each, 2 km apart, and the same groups one by one.
  const auto group = [](core::Block& b, double x, double y) {
    for (int k = 0; k < 5; ++k) b.x.push_back(x + 3.0 * k), b.y.push_back(y + 2.0 * (k % 2)), b.z.push_back(100.0 + (k == 3 ? 4.0 : 0.0));
  };
  core::Block all;
  std::vector<core::Block> apart(4);
  for (int k = 0; k < 4; ++k) {
    const double x = 2000.0 * (k % 2) + 0.5, y = 2000.0 * (k / 2) + 0.5;
    group(all, x, y);
    group(apart[static_cast<size_t>(k)], x, y);
  }
  core::resize(all, all.x.size());
  classify_ground(all, all.size(), {});
  for (size_t k = 0; k < apart.size(); ++k) {
    core::resize(apart[k], 5);
    classify_ground(apart[k], 5, {});
    for (size_t p = 0; p < 5; ++p) {
      EXPECT_EQ(all.classification[5 * k + p], apart[k].classification[p]) << k << " " << p;
      EXPECT_EQ(all.ground_probability[5 * k + p], apart[k].ground_probability[p]) << k << " " << p;
    }
  }
}

TEST(Ground, CropsAreTakenOff) {
  test::Scene s = test::make_scene("flat");
  for (size_t p = 0; p < s.block.size(); ++p)
    if (p % 2 != 0 && s.block.x[p] > 60 && s.block.x[p] < 140) {
      s.block.z[p] += 0.15 + 0.6 * std::fmod(0.618034 * static_cast<double>(p), 1.0);
      s.truth[p] = core::point_class::low_vegetation;
    }
  classify_ground(s.block, s.block.size(), {});
  const test::GroundErrors e = test::ground_errors(s.block, s.truth);
  EXPECT_LT(e.type_1(), 2.0);
  EXPECT_LT(e.type_2(), 5.0);
}

TEST(Ground, ASpurThatNoDiskRestsOnStays) {
  core::Block b = test::make_scene("flat").block;
  // 12 m high, its sides of 35 degrees.
  for (size_t p = 0; p < b.size(); ++p)
    b.z[p] += std::max(0.0, 12.0 - 0.7 * std::max(std::abs(b.x[p] - 100.0), std::abs(b.y[p] - 80.0) - 30.0));
  classify_ground(b, b.size(), {});
  const auto kept = static_cast<size_t>(std::count(b.classification.begin(), b.classification.end(), core::point_class::ground));
  EXPECT_GT(kept, b.size() * 997 / 1000);  // of a spur that is cut off, 4 % of all are lost
}

TEST(Ground, StockpilesKeepTheirTops) {
  constexpr double repose = 0.7265, top = 12.0;  // 36 deg; m
  core::Block b = test::make_scene("flat").block;
  const auto pile = [&](size_t p) { return top - repose * (std::hypot(1.0, std::hypot(b.x[p] - 100.0, b.y[p] - 80.0)) - 1.0); };
  size_t on_top = 0, kept = 0;
  for (size_t p = 0; p < b.size(); ++p) b.z[p] += std::max(0.0, pile(p));
  classify_ground(b, b.size(), {});
  for (size_t p = 0; p < b.size(); ++p) {
    if (pile(p) < 0.5 * top) continue;
    ++on_top;
    kept += b.classification[p] == core::point_class::ground;
  }
  ASSERT_GT(on_top, 200U);
  EXPECT_GE(kept, on_top * 98 / 100);
}

/// Six scenes in a row, 1200 m x 160 m, with sheer steps between them.
core::Block six_scenes() {
  core::Block all;
  int k = 0;
  for (const char* name : {"town", "forest", "scarp", "bridge", "strip_edge", "slope"}) {
    core::Block b = test::make_scene(name).block;
    for (double& x : b.x) x += k * test::scene_width;
    for (size_t p = 0; p < b.size(); p += 997) b.z[p] += p % 2 == 0 ? 25.0 : -6.0;
    if (k++ == 0)
      all = b;
    else
      core::append(all, b);
  }
  return all;
}

TEST(Ground, LabelsDependNeitherOnTilesNorOnOrder) {
  GroundOptions o;
  o.widest = core::Metres(8.0);
  o.longest = core::Metres(16.0);
  ASSERT_LT(halo(o), 400.0);  // so that tiles do not see the whole
  const auto filter = [&](core::Block& b, size_t own) { classify_ground(b, own, o); };
  const core::Block start = six_scenes();
  core::Block whole = start;
  filter(whole, whole.size());
  const core::Block tiles = test::run_tiled(start, 150.0, halo(o), filter);
  EXPECT_EQ(tiles.classification, whole.classification);
  EXPECT_EQ(tiles.ground_probability, whole.ground_probability);
  std::vector<std::uint32_t> rows;
  core::Block mixed = test::shuffled(start, 11, rows);
  filter(mixed, mixed.size());
  const core::Block expected = core::select(whole, rows);
  EXPECT_EQ(mixed.classification, expected.classification);
  EXPECT_EQ(mixed.ground_probability, expected.ground_probability);
}

TEST(Ground, OfTheFarHaloTheLowestReturnOfEachCellSuffices) {
  GroundOptions o;
  o.widest = core::Metres(8.0);
  o.longest = core::Metres(16.0);
  ASSERT_GT(halo(o), near_halo(o) + 50.0);
  const core::Block start = six_scenes();
  size_t left_out = 0;
  const auto filter = [&](core::Block& b, size_t own, bool thin) {
    if (!thin || own == b.size()) {
      classify_ground(b, own, o);
      return;
    }
    const core::Lattice box = lattice_around(b, own, 1.0, 0.0, 0);
    std::vector<std::uint32_t> around(b.size() - own);
    std::iota(around.begin(), around.end(), static_cast<std::uint32_t>(own));
    std::vector<std::uint32_t> rows(own);
    std::iota(rows.begin(), rows.end(), 0U);
    for (const std::uint32_t row : needed_around(core::select(b, around), {box.west(), box.south(), box.east(), box.north()}, o))
      rows.push_back(around[row]);
    left_out += b.size() - rows.size();
    core::Block thinned = core::select(b, rows);
    classify_ground(thinned, own, o);
    core::add_columns(b, {core::Column::classification, core::Column::ground_probability});
    std::copy_n(thinned.classification.begin(), own, b.classification.begin());
    std::copy_n(thinned.ground_probability.begin(), own, b.ground_probability.begin());
  };
  const core::Block whole = test::run_tiled(start, 150.0, halo(o), [&](core::Block& b, size_t own) { filter(b, own, false); });
  const core::Block thinned = test::run_tiled(start, 150.0, halo(o), [&](core::Block& b, size_t own) { filter(b, own, true); });
  EXPECT_GT(left_out, 1000u);
  EXPECT_EQ(thinned.classification, whole.classification);
  EXPECT_EQ(thinned.ground_probability, whole.ground_probability);
}

TEST(Ground, NoiseEarlyReturnsAndHaloKeepOut) { test::expect_only_own_last_returns_judged(run); }

TEST(Ground, WhereNothingMayBeGroundNoSurfaceIsMade) {
  // 25 km2 with some few points, all of them noise: rasters of a metre over it would take 2 GB and 20 s.
  core::Block b;
  b.origin = {500000.0, 5300000.0, 0.0};
  core::resize(b, 3000);
  core::add_columns(b, {core::Column::flags, core::Column::classification});
  for (size_t p = 0; p < b.size(); ++p) {
    b.x[p] = std::fmod(static_cast<double>(p) * 1618.0339, 5000.0);
    b.y[p] = std::fmod(static_cast<double>(p) * 754.8777, 5000.0);
    b.z[p] = 100.0;
    b.classification[p] = core::point_class::high_noise;
  }
  const auto start = std::chrono::steady_clock::now();
  const GroundCounts n = run(b, b.size());
  EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(), 1.0);
  EXPECT_EQ(n.ground, 0u);
  EXPECT_EQ(n.untouched, b.size());
}

TEST(Ground, ProbabilityIsGivenToAllThatAreJudgedAndAgreesWithTheClass) {
  test::Scene s = test::make_scene("town");
  s.block.flags[0] = core::flag::withheld;
  s.block.return_count[1] = 2;
  const GroundChances n = classify_ground(s.block, s.block.size(), {});
  EXPECT_EQ(n.untouched, 1u);
  EXPECT_TRUE(std::isnan(s.block.ground_probability[0]));
  EXPECT_EQ(s.block.ground_probability[1], 0.0F);
  double different = 0;
  for (size_t p = 1; p < s.block.size(); ++p) {
    const float stated = s.block.ground_probability[p];
    ASSERT_GE(stated, 0.0F);
    ASSERT_LE(stated, 1.0F);
    different += (stated >= 0.5F) != (s.block.classification[p] == core::point_class::ground);
  }
  EXPECT_EQ(different, 0);
}

TEST(Ground, ProbabilityIsTheShareOfGroundInALowCrop) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> part(0.0, 1.0);
  std::normal_distribution<double> soil(0.0, 0.018);
  core::Block b;
  b.origin = {512000.0, 5402000.0, 0.0};
  core::resize(b, 60000);
  std::vector<char> plant(b.size());
  for (size_t p = 0; p < b.size(); ++p) {
    b.x[p] = 100.0 * part(random), b.y[p] = 100.0 * part(random);
    plant[p] = b.x[p] > 40.0 && part(random) < 0.7;
    b.z[p] = soil(random) + (plant[p] ? 0.09 + 0.06 * part(random) : 0.0);
  }
  GroundOptions o;
  o.grass = Grass::bare_earth;
  classify_ground(b, b.size(), o);
  std::array<double, 10> count{}, stated{}, ground{};
  for (size_t p = 0; p < b.size(); ++p) {
    const auto decile = static_cast<size_t>(std::min(9.0F, 10.0F * b.ground_probability[p]));
    count[decile] += 1, stated[decile] += b.ground_probability[p], ground[decile] += !plant[p];
  }
  constexpr double bearable = 0.15;
  for (size_t k = 0; k < 10; ++k) {
    if (count[k] >= 1000) {  // fewer are the rim of the field
      EXPECT_NEAR(stated[k] / count[k], ground[k] / count[k], bearable) << "decile " << k << " of " << count[k];
    }
  }
  EXPECT_GT(count[0], 10000.0) << "crop that is told";
}

TEST(Ground, AWideBuildingStaysOnlyWhereNeitherWidthNorWallsMayTakeIt) {
  test::Scene s = hall();
  GroundOptions o;
  o.widest = core::Metres(12.0);
  classify_ground(s.block, s.block.size(), o);
  EXPECT_LT(test::ground_errors(s.block, s.truth).type_2(), 2.0);
  o.longest = core::Metres(0.0);
  classify_ground(s.block, s.block.size(), o);
  EXPECT_GT(test::ground_errors(s.block, s.truth).type_2(), 30.0);
}

}  // namespace
}  // namespace swath::filters
