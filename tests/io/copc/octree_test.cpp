// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/copc/octree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <random>
#include <set>

namespace swath::io {
namespace {

struct Made {
  OctreeCube cube;
  std::vector<Eigen::Vector3d> points;  // along the curve
  std::vector<std::uint64_t> codes, priorities;
};

/// A hilly surface, so dense in one corner that nodes are divided there.
Made surface(std::size_t n, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  Made m;
  for (std::size_t i = 0; i < n; ++i) {
    const double s = i % 2 ? 1.0 : 0.1, x = 1000.0 * s * unit(random), y = 800.0 * s * unit(random);
    m.points.emplace_back(x, y, 20.0 * std::sin(x / 100.0) + 5.0 * unit(random));
  }
  Eigen::Vector3d low = m.points[0], high = low;
  for (const Eigen::Vector3d& p : m.points) low = low.cwiseMin(p), high = high.cwiseMax(p);
  m.cube = OctreeCube::around(low, high);
  std::sort(m.points.begin(), m.points.end(),
            [&](const auto& a, const auto& b) { return octree_code(m.cube, a) < octree_code(m.cube, b); });
  for (const Eigen::Vector3d& p : m.points) m.codes.push_back(octree_code(m.cube, p)), m.priorities.push_back(random());
  return m;
}

TEST(Octree, KeysOfACodeAreTheCubesAroundThePoint) {
  const Made m = surface(2000, 1);
  for (std::size_t i = 0; i < m.points.size(); i += 17)
    for (const int level : {0, 1, 5, octree::max_level}) {
      const OctreeKey key = octree_key(m.codes[i], level);
      const OctreeCube c = m.cube.of(key);
      EXPECT_LE((m.points[i] - c.centre).cwiseAbs().maxCoeff(), c.half_side * (1.0 + 1e-9)) << key.text();
      if (level > 0) {
        EXPECT_EQ(key.parent(), octree_key(m.codes[i], level - 1));
      }
    }
  const OctreeKey far{3, 7, 0, 5};
  EXPECT_EQ(far.text(), "3-7-0-5");
  for (int octant = 0; octant < 8; ++octant) EXPECT_EQ(far.child(octant).parent(), far);
}

TEST(Octree, PointsOutsideTheCubeCountAsAtItsRim) {
  const OctreeCube cube{{0, 0, 0}, 1.0};
  EXPECT_EQ(octree_code(cube, {-5, -5, -5}), 0u);
  EXPECT_EQ(octree_key(octree_code(cube, {9, 1, 2}), 2), (OctreeKey{2, 3, 3, 3}));
  EXPECT_GT(OctreeCube::around({1, 1, 1}, {1, 1, 1}).side(), 0.0);
}

// Against the definition, in quadratic time: a point's level is the first on which no other in its cell has a lower priority.
TEST(Octree, LevelsAreThoseOfTheDefinition) {
  const Made m = surface(1500, 2);
  const std::vector<std::uint8_t> levels = octree_levels(m.codes, m.priorities);
  std::set<int> seen;
  for (std::size_t i = 0; i < m.codes.size(); ++i) {
    int level = 0;
    const auto is_lowest = [&](int l) {
      const int shift = 3 * (octree::depth_bits - octree::cell_bits - l);
      for (std::size_t k = 0; k < m.codes.size(); ++k)
        if (k != i && m.codes[k] >> shift == m.codes[i] >> shift && m.priorities[k] < m.priorities[i]) return false;
      return true;
    };
    while (level < octree::max_level && !is_lowest(level)) ++level;
    EXPECT_EQ(levels[i], level) << i;
    seen.insert(level);
  }
  EXPECT_GT(seen.size(), 1u);
}

TEST(Octree, LevelsOfAPartAreThoseOfTheWhole) {
  const Made m = surface(40000, 3);
  const std::vector<std::uint8_t> whole = octree_levels(m.codes, m.priorities);
  for (std::size_t begin = 0; begin < m.codes.size();) {
    std::size_t end = begin;
    while (end < m.codes.size() && octree_key(m.codes[end], 3) == octree_key(m.codes[begin], 3)) ++end;
    const std::size_t n = end - begin;
    const std::vector<std::uint8_t> part = octree_levels(std::span(m.codes).subspan(begin, n), std::span(m.priorities).subspan(begin, n));
    EXPECT_TRUE(std::equal(part.begin(), part.end(), whole.begin() + static_cast<std::ptrdiff_t>(begin)));
    begin = end;
  }
}

TEST(Octree, EveryPointIsInOneNodeAndChildrenComeFirst) {
  const Made m = surface(300000, 4);
  const std::vector<std::uint8_t> levels = octree_levels(m.codes, m.priorities);
  std::vector<int> times(m.codes.size());
  std::map<OctreeKey, std::size_t> order;
  visit_octree({}, m.codes, levels, [&](const OctreeKey& key, std::vector<std::uint32_t>& mine) {
    order.emplace(key, order.size());
    std::set<std::uint64_t> cells;
    for (const std::uint32_t i : mine) {
      ++times[i];
      EXPECT_EQ(octree_key(m.codes[i], key.level), key);
      cells.insert(m.codes[i] >> 3 * (octree::depth_bits - octree::cell_bits - key.level));
    }
    if (key.level < 1) {
      EXPECT_EQ(cells.size(), mine.size()) << "one point a cell, where the node is divided";
    }
  });
  EXPECT_TRUE(std::all_of(times.begin(), times.end(), [](int n) { return n == 1; }));
  EXPECT_GT(order.size(), 5u);
  for (const auto& [key, at] : order) {
    if (key.level == 0) continue;
    ASSERT_TRUE(order.contains(key.parent())) << key.text();
    EXPECT_LT(at, order[key.parent()]);
  }
}

TEST(Octree, PointsAtOnePlaceShareTheDeepestNode) {
  const std::size_t n = octree::leaf_points + 1;
  std::vector<std::uint64_t> codes(n, 12345), priorities(n);
  std::iota(priorities.begin(), priorities.end(), 0u);
  const std::vector<std::uint8_t> levels = octree_levels(codes, priorities);
  EXPECT_EQ(levels[0], 0);
  std::map<int, std::size_t> points;
  visit_octree({}, codes, levels, [&](const OctreeKey& key, std::vector<std::uint32_t>& mine) { points[key.level] = mine.size(); });
  EXPECT_EQ(points.at(0), 1u);
  EXPECT_EQ(points.at(5), 0u) << "a node without points of its own leads to the one below";
  EXPECT_EQ(points.at(octree::max_level), n - 1);
}

}  // namespace
}  // namespace swath::io
