// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/corridor/passing.h"

#include <gtest/gtest.h>

#include "terrain/corridor/spans.h"
#include "tests/world/power_line.h"

namespace swath::terrain {
namespace {

void split(const test::PowerLineScene& s, std::vector<WirePoint>& wires, std::vector<TowerPoint>& towers) {
  for (size_t p = 0; p < s.block.size(); ++p) {
    if (s.truth[p] == core::point_class::wire) wires.push_back({s.block.x[p], s.block.y[p], s.block.z[p], s.block.strip[p]});
    if (s.truth[p] == test::tower_class) towers.push_back({s.block.x[p], s.block.y[p], s.block.z[p]});
  }
}

// A tree's top just below the wires of each span. At a tenth of it few returns of thin clouds lie between the tree and the support.
TEST(Passing, WiresThatRunOnAsOneCurveHaveNoSupportThere) {
  for (const double density : {1.5, 3.0, 8.0})
    for (unsigned seed = 1; seed <= 5; ++seed) {
      test::LineOfWires o;
      o.density = density, o.seed = seed, o.trees = false;
      const test::PowerLineScene s = test::make_power_line(o);
      std::vector<WirePoint> wires;
      std::vector<TowerPoint> tops;
      split(s, wires, tops);
      const std::vector<double> shares{density < 2.0 ? 0.3 : 0.1, 0.25, 0.5};
      for (size_t k = 0; k < shares.size(); ++k) {
        const test::TrueWire& w = s.wires[3 * k];  // one of span k
        const Eigen::Vector3d below = w.at(shares[k] * w.length);
        for (int level = 0; level < 6; ++level) tops.push_back({below.x() + 1.0, below.y(), below.z() - 2.0 - level});
      }
      const PowerLines found = find_power_lines(wires, tops);
      EXPECT_EQ(found.spans.size(), 3u) << density << " per m2, seed " << seed;
      EXPECT_EQ(found.pylons.size(), s.pylons.size()) << density << " per m2, seed " << seed;
    }
}

TEST(Passing, SupportsThatCarryAreNotPassed) {
  test::LineOfWires o;
  o.trees = false;
  const test::PowerLineScene s = test::make_power_line(o);
  std::vector<WirePoint> wires;
  std::vector<TowerPoint> towers;
  split(s, wires, towers);
  const std::vector<TowerGroup> groups = tower_groups(towers);
  ASSERT_EQ(groups.size(), 4u);
  std::vector<Eigen::Vector2d> supports;
  for (const TowerGroup& g : groups) supports.push_back(g.at);
  EXPECT_EQ(passed_by_wires(wires, find_strands(wires, supports), groups, {}), std::vector<char>(4, 0));
  EXPECT_TRUE(passed_by_wires({}, {}, {}, {}).empty());
}

}  // namespace
}  // namespace swath::terrain
