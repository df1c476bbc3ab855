// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/ground/patches.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <tuple>

#include "tests/world/scene.h"

namespace swath::filters {
namespace {

constexpr Patching how{30.0, 40.0};  // the margin is wider than the square

using Place = std::tuple<double, double, double>;
using Seen = std::map<std::pair<double, double>, std::vector<Place>>;

Seen patches_of(const core::Block& b, size_t own) {
  Seen seen;
  for_each_patch(
      b, own, how, [](size_t) { return true; },
      [&](const Patch& patch) {
        auto& places = seen[{patch.x0, patch.y0}];
        for (const std::uint32_t p : patch.rows) places.emplace_back(b.x[p], b.y[p], b.z[p]);
      });
  return seen;
}

TEST(Patches, EveryOwnPointIsInOneSquareWithAllPointsAroundIt) {
  const core::Block b = test::make_scene("town").block;
  std::vector<int> owners(b.size(), 0);
  for_each_patch(
      b, b.size(), how, [](size_t p) { return p % 3 != 0; },
      [&](const Patch& patch) {
        EXPECT_EQ(std::fmod(patch.x0, how.side), 0.0);
        size_t expected = 0;
        for (size_t p = 0; p < b.size(); ++p) {
          const double x = b.origin.x() + b.x[p] - patch.x0, y = b.origin.y() + b.y[p] - patch.y0;
          const double low = -how.margin, high = how.side + how.margin;
          expected += p % 3 != 0 && x >= low && x < high && y >= low && y < high;
        }
        EXPECT_EQ(patch.rows.size(), expected);
        for (const std::uint32_t p : patch.rows) owners[p] += patch.owns(b.origin.x() + b.x[p], b.origin.y() + b.y[p]);
      });
  for (size_t p = 0; p < b.size(); ++p) EXPECT_EQ(owners[p], p % 3 != 0 ? 1 : 0);
}

TEST(Patches, TheSameSquareIsSeenAlikeFromEveryTileAndInEveryOrder) {
  const core::Block b = test::make_scene("town").block;
  const Seen whole = patches_of(b, b.size());
  std::vector<std::uint32_t> rows;
  EXPECT_EQ(patches_of(test::shuffled(b, 3, rows), b.size()), whole);

  // A tile from (70, 50) to (110, 90) with its halo.
  const auto inside = [&](size_t p, double grown) {
    return b.x[p] >= 70.0 - grown && b.x[p] < 110.0 + grown && b.y[p] >= 50.0 - grown && b.y[p] < 90.0 + grown;
  };
  std::vector<std::uint32_t> own, halo;
  for (std::uint32_t p = 0; p < b.size(); ++p) {
    if (inside(p, 0.0)) own.push_back(p);
    if (!inside(p, 0.0) && inside(p, how.halo())) halo.push_back(p);
  }
  const size_t n = own.size();
  own.insert(own.end(), halo.begin(), halo.end());
  ASSERT_LT(own.size(), b.size());
  const Seen tile = patches_of(core::select(b, own), n);
  EXPECT_GE(tile.size(), 4u);
  for (const auto& [corner, places] : tile) EXPECT_EQ(places, whole.at(corner));
}

TEST(Patches, NoPointsNoPatches) { EXPECT_TRUE(patches_of({}, 0).empty()); }

}  // namespace
}  // namespace swath::filters
