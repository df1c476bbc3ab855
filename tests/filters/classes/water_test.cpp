// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/classes/water.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "core/config/option_visitors.h"
#include "tests/world/scene.h"

namespace swath::filters {
namespace {

namespace cls = core::point_class;

constexpr double side = 240.0;  // m

struct Place {
  double z;
  double share;  ///< of the pulses that come back
  std::uint8_t kind = cls::ground;
};

/// Two lines of four pulses per square metre each over `ground`; 3 cm of noise. The first class is truth's.
struct Flown {
  core::Block block;
  std::vector<std::uint8_t> truth;
};
Flown fly(const std::function<Place(double, double, int)>& ground, std::uint16_t lines = 1) {
  Flown f;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::normal_distribution<double> noise(0.0, 0.03);
  std::vector<std::uint16_t> strip;
  for (std::uint16_t line = 1; line <= lines; ++line)
    for (double y = 0.0; y < side; y += 0.5)
      for (double x = 0.0; x < side; x += 0.5) {
        const double px = x + 0.5 * uniform(random), py = y + 0.5 * uniform(random), chance = uniform(random), error = noise(random);
        const Place p = ground(px, py, line);
        if (chance >= p.share) continue;
        test::add_point(f.block, px, py, p.z + error);
        strip.push_back(line);
        f.truth.push_back(p.kind);
      }
  core::add_columns(f.block, {core::Column::classification, core::Column::flags, core::Column::strip});
  f.block.strip = strip;
  std::fill(f.block.classification.begin(), f.block.classification.end(), cls::ground);
  return f;
}

/// A lake of 50 m radius in a hollow; line 1 sees a part of it near its nadir.
Place lake(double x, double y, int line) {
  const double r = std::hypot(x - 120.0, y - 120.0);
  if (r > 50.0) return {100.0 + 0.08 * (r - 50.0), 1.0};
  const double off_nadir = std::abs(x - (line == 1 ? 90.0 : 300.0)) / 500.0;
  return {100.0, 0.02 + 0.98 * std::exp(-0.5 * std::pow(off_nadir / 0.02, 2)), cls::water};
}

double share_of_water(const Flown& f, std::uint8_t kind) {
  double said = 0, all = 0;
  for (size_t p = 0; p < f.truth.size(); ++p)
    if (f.truth[p] == kind) ++all, said += f.block.classification[p] == cls::water;
  return said / all;
}

TEST(Water, ALakeWithItsGlintIsFoundAndItsShoreIsNot) {
  constexpr double found = 0.96, taken = 0.004;  // of the lake's returns, of the land's: a strip of 0.6 m along the shore
  for (const std::uint16_t lines : {std::uint16_t{1}, std::uint16_t{2}}) {
    Flown f = fly(lake, lines);
    const WaterCounts n = classify_water(f.block, f.block.size(), {});
    EXPECT_GE(share_of_water(f, cls::water), found) << lines;
    EXPECT_LE(share_of_water(f, cls::ground), taken) << lines;
    EXPECT_EQ(n.ground, n.water);
    EXPECT_GT(n.water, 1000u);
  }
}

TEST(Water, APondUnderTheNadirIsFoundWhereTheLandRisesAround) {
  const auto pond = [](double x, double y, int) {
    const double r = std::hypot(x - 120.0, y - 120.0);
    return r < 13.0 ? Place{100.0, 1.0, cls::water} : Place{100.0 + 0.1 * (r - 13.0), 1.0};
  };
  Flown f = fly(pond);
  classify_water(f.block, f.block.size(), {});
  constexpr double found = 0.9, taken = 0.003;
  EXPECT_GE(share_of_water(f, cls::water), found);
  EXPECT_LE(share_of_water(f, cls::ground), taken);
  f = fly(pond);
  WaterOptions near;
  near.reach = core::Metres(8.0);  // it goes on beyond: level land, of which a part is sparse
  EXPECT_EQ(classify_water(f.block, f.block.size(), near).water, 0u);
  // What is not ground is none: a flat roof in the middle of higher ones.
  f = fly(pond);
  std::fill(f.block.classification.begin(), f.block.classification.end(), cls::unassigned);
  EXPECT_EQ(classify_water(f.block, f.block.size(), {}).water, 0u);
}

TEST(Water, ARiverThatFallsIsFound) {
  const auto river = [](double x, double y, int) {
    const double across = std::abs(y - 120.0 - 20.0 * std::sin(x / 40.0)), level = 100.0 - 0.001 * x;
    return across < 8.0 ? Place{level, 0.04, cls::water} : Place{level + 0.3 * std::min(across - 8.0, 10.0), 1.0};
  };
  Flown f = fly(river);
  classify_water(f.block, f.block.size(), {});
  constexpr double found = 0.85, taken = 0.002;  // within 2 m of the shore, a quarter of the river, its returns are not sparse
  EXPECT_GE(share_of_water(f, cls::water), found);
  EXPECT_LE(share_of_water(f, cls::ground), taken);
}

TEST(Water, VoidsDarkRoofsRoadsAndLevelFieldsAreNone) {
  const std::vector<std::pair<const char*, std::function<Place(double, double, int)>>> places = {
      {"level field",
       [](double, double, int) {
         return Place{100.0, 1.0};
       }},
      {"level terrace",
       [](double x, double, int) {
         return Place{100.0 + 0.2 * std::max(0.0, x - 140.0) - 0.2 * std::max(0.0, 100.0 - x), 1.0};
       }},
      {"court that drains in a hollow",
       [](double x, double y, int) {
         const double r = std::max(std::abs(x - 120.0), std::abs(y - 120.0));
         return Place{r < 25.0 ? 100.0 + 0.005 * x : 100.6 + 0.3 * (r - 25.0), 1.0};
       }},
      {"clearing on a level",
       [](double x, double y, int) {
         const bool tree = std::hypot(x - 120.0, y - 120.0) > 30.0 && std::fmod(13.7 * x + 7.3 * y, 1.0) < 0.6;
         return Place{tree ? 112.0 : 100.0, 1.0};
       }},
      {"gap between lines",
       [](double x, double y, int) {
         return Place{100.0, std::abs(x + 0.2 * y - 120.0) < 15.0 ? 0.0 : 1.0};
       }},
      {"shadows",
       [](double x, double y, int) {
         return Place{100.0, std::fmod(x, 40.0) < 12.0 && std::fmod(y, 40.0) < 15.0 ? 0.0 : 1.0};
       }},
      {"dark flat roof",
       [](double x, double y, int) {
         const bool roof = std::abs(x - 120.0) < 25.0 && std::abs(y - 120.0) < 40.0;
         return roof ? Place{108.0, 0.03} : Place{100.0, 1.0};
       }},
      {"dark road",
       [](double x, double y, int) {
         const bool road = std::abs(y - 120.0) < 8.0;
         return Place{100.0 + 0.006 * x, road ? 0.03 : 1.0};
       }},
      {"dark yard that drains",
       [](double x, double y, int) {
         const double r = std::max(std::abs(x - 120.0), std::abs(y - 120.0));
         return r < 30.0 ? Place{100.0 + 0.01 * r, 0.03} : Place{100.3, 1.0};
       }},
      {"thin all over",
       [](double, double, int) {
         return Place{100.0, 0.1};
       }},
  };
  for (const auto& [name, place] : places) {
    Flown f = fly(place);
    EXPECT_EQ(classify_water(f.block, f.block.size(), {}).water, 0u) << name;
  }
  for (const std::string& name : test::scene_names()) {
    test::Scene s = test::make_scene(name);
    s.block.classification = s.truth;
    EXPECT_EQ(classify_water(s.block, s.block.size(), {}).water, 0u) << name;
  }
}

TEST(Water, DoesNotDependOnTilesOrOrder) {
  const Flown f = fly(lake, 2);
  core::Block whole = f.block;
  classify_water(whole, whole.size(), {});
  WaterOptions near;
  near.reach = core::Metres(24.0);
  for (const WaterOptions& o : {WaterOptions{}, near}) {
    whole = f.block;
    EXPECT_GT(classify_water(whole, whole.size(), o).water, 500u);
    const auto filter = [&](core::Block& b, size_t own) { classify_water(b, own, o); };
    EXPECT_EQ(test::run_tiled(f.block, 61.0, halo(o), filter).classification, whole.classification);
  }
  std::vector<std::uint32_t> rows;
  core::Block other = test::shuffled(f.block, 3, rows);
  classify_water(other, other.size(), near);
  for (size_t k = 0; k < rows.size(); ++k) ASSERT_EQ(other.classification[k], whole.classification[rows[k]]);
}

TEST(Water, OtherClassesNoiseAndHaloStay) {
  Flown f = fly(lake);
  core::Block found = f.block;
  classify_water(found, found.size(), {});
  std::vector<size_t> inside;
  for (size_t p = 0; p < f.truth.size(); ++p)
    if (found.classification[p] == cls::water) inside.push_back(p);
  ASSERT_GT(inside.size(), 10u);
  f.block.classification[inside[0]] = cls::high_noise;
  f.block.classification[inside[1]] = cls::building;
  f.block.classification[inside[2]] = cls::unassigned;
  const size_t own = inside.back();
  classify_water(f.block, own, {});
  EXPECT_EQ(f.block.classification[inside[0]], cls::high_noise);
  EXPECT_EQ(f.block.classification[inside[1]], cls::building);
  EXPECT_EQ(f.block.classification[inside[2]], cls::water);
  EXPECT_EQ(f.block.classification[own], cls::ground);
}

}  // namespace
}  // namespace swath::filters
