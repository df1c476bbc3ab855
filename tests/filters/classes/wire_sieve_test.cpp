// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/classes/wire_sieve.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "tests/world/scene.h"

namespace swath::filters {
namespace {

/// Ground, a dense crown over x from 20 to 40, three wires side by side over x from 45 on; `airy` of crown and wires.
struct Scene {
  core::Block block;
  std::vector<std::uint8_t> candidate, wire;
};

Scene scene(double spacing) {
  Scene s;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  const auto add = [&s](double x, double y, double z, bool candidate, bool wire) {
    test::add_point(s.block, x, y, z);
    s.candidate.push_back(candidate), s.wire.push_back(wire);
  };
  for (double y = 0.0; y < 40.0; y += spacing)
    for (double x = 0.0; x < 80.0; x += spacing) add(x, y, 0.0, false, false);
  for (double y = 0.0; y < 40.0; y += spacing)
    for (double x = 20.0; x < 40.0; x += spacing) add(x, y, 10.0 + uniform(random), true, false);
  for (double y = 0.0; y < 40.0; y += spacing)
    for (const double x : {60.0, 61.0, 62.0}) add(x, y, 10.0 + 0.01 * y, true, true);
  return s;
}

TEST(WireSieve, KeepsWiresAndDropsCrownsAtAnyDensity) {
  for (const double spacing : {0.3, 0.7, 1.2, 1.9}) {
    const Scene s = scene(spacing);
    const std::vector<std::uint8_t> airy =
        airy_points(s.block, s.candidate, std::vector<std::uint8_t>(s.block.size(), 0), districts(s.block));
    double crown = 0, kept = 0;
    for (size_t p = 0; p < airy.size(); ++p) {
      EXPECT_TRUE(!airy[p] || s.candidate[p]);
      EXPECT_TRUE(airy[p] || !s.wire[p]) << spacing << " " << s.block.y[p];
      if (s.candidate[p] && !s.wire[p]) ++crown, kept += airy[p];
    }
    EXPECT_LE(kept, 0.55 * crown) << spacing;  // its rim
  }
}

TEST(WireSieve, ASurfaceBesideCounts) {
  const Scene s = scene(0.5);
  std::vector<std::uint8_t> wires = s.wire, crown = s.candidate;
  for (size_t p = 0; p < wires.size(); ++p) crown[p] = crown[p] && !wires[p];
  const std::vector<std::uint8_t> none(wires.size(), 0);
  const auto count = [](const std::vector<std::uint8_t>& v) { return std::count(v.begin(), v.end(), 1); };
  EXPECT_GT(count(airy_points(s.block, wires, none, districts(s.block))), 0);
  std::vector<std::uint8_t> half = none, other = none;
  for (size_t p = 0; p < half.size(); ++p)
    if (crown[p]) (s.block.y[p] < 20.0 ? half : other)[p] = 1;
  EXPECT_LT(count(airy_points(s.block, half, other, districts(s.block))), count(airy_points(s.block, half, none, districts(s.block))));
}

}  // namespace
}  // namespace swath::filters
