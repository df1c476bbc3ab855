// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/wires.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/world/scene.h"

namespace swath::filters {
namespace {

void add_point(core::Block& b, double x, double y, double z) {
  core::resize(b, b.size() + 1);
  b.x.back() = x, b.y.back() = y, b.z.back() = z;
}

TEST(Wires, ThreeWiresSideBySideAreFoundToTheirEnds) {
  core::Block b;
  for (const double offset : {-3.0, 0.0, 3.0})
    for (double u = 0.0; u < 120.0; u += 1.3 + 0.4 * std::sin(u + offset))
      add_point(b, 0.8 * u - 0.6 * offset, 0.6 * u + 0.8 * offset,
                20.0 + 500.0 * (std::cosh((u - 60.0) / 500.0) - 1.0) + 0.03 * std::sin(7 * u));
  const std::vector<std::uint8_t> wire = wire_points(b, std::vector<std::uint8_t>(b.size(), 1));
  for (size_t p = 0; p < b.size(); ++p) EXPECT_TRUE(wire[p]) << b.x[p] << " " << b.y[p];
}

TEST(Wires, CrownsMastsAndSinglePointsAreNone) {
  test::Scene s = test::make_scene("forest");
  std::vector<std::uint8_t> candidate(s.block.size());
  for (size_t p = 0; p < candidate.size(); ++p) candidate[p] = s.truth[p] != core::point_class::ground;
  double found = 0;
  for (const std::uint8_t w : wire_points(s.block, candidate)) found += w;
  constexpr double bearable = 0.005;  // of the returns from thin crowns
  EXPECT_LE(found, bearable * static_cast<double>(s.block.size()));

  core::Block mast;
  for (int k = 0; k < 20; ++k) add_point(mast, 10.0, 10.0, 10.0 + k);
  for (const std::uint8_t w : wire_points(mast, std::vector<std::uint8_t>(mast.size(), 1))) EXPECT_FALSE(w);
}

}  // namespace
}  // namespace swath::filters
