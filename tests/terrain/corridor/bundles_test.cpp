// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/corridor/bundles.h"

#include <gtest/gtest.h>

#include "tests/world/power_line.h"

namespace swath::terrain {
namespace {

std::vector<Bundle> bundles(const test::LineOfWires& o, double east_of_second_line = 0.0) {
  const test::PowerLineScene s = test::make_power_line(o);
  std::vector<WirePoint> points;
  for (size_t p = 0; p < s.block.size(); ++p)
    if (s.truth[p] == core::point_class::wire)
      points.push_back({s.block.x[p] + (s.block.strip[p] == 2 ? east_of_second_line : 0.0), s.block.y[p], s.block.z[p], s.block.strip[p]});
  std::vector<Bundle> out;
  for (const Strand& strand : find_strands(points, {})) out.push_back(bundle_of(points, strand));
  return out;
}

test::LineOfWires one_span() {
  test::LineOfWires o;
  o.turns = {0.0};
  o.trees = false;
  return o;
}

TEST(Bundles, TwoAndFourWiresAreDistinguishedFromOne) {
  test::LineOfWires o = one_span();
  for (const Bundle& b : bundles(o)) EXPECT_EQ(b.wires, 1);
  constexpr double tolerance = 0.02;  // m: EM's places of 360 returns
  o.bundle = {{-0.2, 0.0}, {0.2, 0.0}};
  for (const Bundle& b : bundles(o)) {
    EXPECT_EQ(b.wires, 2);
    EXPECT_NEAR(b.spacing, 0.4, tolerance);
  }
  o.bundle = {{-0.2, 0.2}, {0.2, 0.2}, {-0.2, -0.2}, {0.2, -0.2}};
  const std::vector<Bundle> four = bundles(o);
  ASSERT_EQ(four.size(), 3u);
  for (const Bundle& b : four) {
    EXPECT_EQ(b.wires, 4);
    EXPECT_NEAR(b.spacing, 0.4, tolerance);
  }
}

TEST(Bundles, FlightLinesThatDoNotFitTogetherMakeNone) {
  test::LineOfWires o = one_span();
  o.step = 0.25;
  for (const Bundle& b : bundles(o, -0.3)) EXPECT_EQ(b.wires, 1);
}

}  // namespace
}  // namespace swath::terrain
