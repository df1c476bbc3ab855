// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/crop.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/world/scene.h"

namespace swath::filters {
namespace {

CropLine square(double x, double y, double side) { return {{x, y}, {x + side, y}, {x + side, y + side}, {x, y + side}}; }

TEST(Crop, AreasWithHolesAndAnAxisHoldWhatTheyShould) {
  const test::Scene s = test::make_scene("flat");
  const CropShapes shapes{{{square(10, 10, 60), square(30, 30, 20)}, {square(60, 60, 30)}}, {{{100, 20}, {150, 20}, {150, 120}}}, 7.0};
  core::Block b = s.block;
  const CropCounts n = crop(b, b.size(), shapes, false);
  EXPECT_EQ(n.inside + n.outside, b.size());
  EXPECT_GT(n.inside, 3000u);
  for (size_t p = 0; p < b.size(); ++p) {
    const double x = b.x[p], y = b.y[p];
    const auto in = [&](double x0, double y0, double side) { return x >= x0 && x < x0 + side && y >= y0 && y < y0 + side; };
    const double to_first = std::hypot(x - std::clamp(x, 100.0, 150.0), y - 20.0),
                 to_second = std::hypot(x - 150.0, y - std::clamp(y, 20.0, 120.0));
    const bool inside = (in(10, 10, 60) && !in(30, 30, 20)) || in(60, 60, 30) || std::min(to_first, to_second) <= 7.0;
    ASSERT_EQ((b.flags[p] & core::flag::withheld) != 0, !inside) << x << " " << y;
  }
  core::Block other = s.block;
  const CropCounts m = crop(other, other.size(), shapes, true);
  EXPECT_EQ(m.inside, n.outside);
  for (size_t p = 0; p < b.size(); ++p) ASSERT_NE(b.flags[p] & core::flag::withheld, other.flags[p] & core::flag::withheld);
}

TEST(Crop, AreasThatShareASideShareNoPointAndTheTilingChangesNothing) {
  const test::Scene s = test::make_scene("town");
  const CropLine whole{{-1e3, -1e3}, {1e3, -1e3}, {1e3, 1e3}, {-1e3, 1e3}}, left{{-1e3, -1e3}, {40, -1e3}, {90, 1e3}, {-1e3, 1e3}};
  core::Block a = s.block, b = s.block;
  const auto n = crop(a, a.size(), {{{left}}, {}, 0.0}, false);
  const auto m = crop(b, b.size(), {{{whole, left}}, {}, 0.0}, false);
  EXPECT_EQ(n.inside, m.outside);
  const core::Block tiled = test::run_tiled(s.block, 37.0, 0.0, [&](core::Block& t, size_t own) {
    crop(t, own, {{{left}}, {}, 0.0}, false);
  });
  EXPECT_EQ(tiled.flags, a.flags);
}

TEST(Crop, WhatWasWithheldStaysSo) {
  test::Scene s = test::make_scene("flat");
  s.block.flags[7] |= core::flag::withheld;
  const auto n = crop(s.block, s.block.size(), {{{{{-1e3, -1e3}, {1e3, -1e3}, {1e3, 1e3}, {-1e3, 1e3}}}}, {}, 0.0}, false);
  EXPECT_EQ(n.untouched, 1u);
  EXPECT_EQ(n.outside, 0u);
  EXPECT_TRUE(s.block.flags[7] & core::flag::withheld);
}

}  // namespace
}  // namespace swath::filters
