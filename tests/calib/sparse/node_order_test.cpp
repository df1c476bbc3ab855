// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/sparse/node_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <set>

namespace swath::calib {
namespace {

/// A lattice of nodes of 3 unknowns, and a chain that begins at its corner.
std::vector<std::vector<int>> lattice(int side, int chain) {
  std::vector<std::vector<int>> out(static_cast<size_t>(side * side + chain));
  const auto tie = [&out](int a, int b) {
    out[static_cast<size_t>(a)].push_back(b);
    out[static_cast<size_t>(b)].push_back(a);
  };
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      if (x + 1 < side) tie(side * y + x, side * y + x + 1);
      if (y + 1 < side) tie(side * y + x, side * y + side + x);
    }
  for (int k = 0; k < chain; ++k) tie(k == 0 ? 0 : side * side + k - 1, side * side + k);
  for (std::vector<int>& list : out) std::sort(list.begin(), list.end());
  return out;
}

std::vector<int> places_by_node(const NodeOrder& order) {
  std::vector<int> out(order.node.size());
  for (size_t p = 0; p < order.node.size(); ++p) out[static_cast<size_t>(order.node[p])] = static_cast<int>(p);
  return out;
}

TEST(NodeOrder, FrontsTakeEachNodeOnceAndHoldAllThatItsEliminationTouches) {
  const auto neighbours = lattice(12, 30);
  const NodeOrder order = order_of(neighbours, std::vector<int>(neighbours.size(), 3));
  const std::vector<int> place = places_by_node(order);
  std::vector<std::set<int>> touched(neighbours.size());  // by elimination of one place after another
  for (size_t p = 0; p < touched.size(); ++p) {
    for (const int b : neighbours[static_cast<size_t>(order.node[p])])
      if (place[static_cast<size_t>(b)] > static_cast<int>(p)) touched[p].insert(place[static_cast<size_t>(b)]);
    if (touched[p].empty()) continue;
    const int next = *touched[p].begin();
    for (const int q : touched[p])
      if (q != next) touched[static_cast<size_t>(next)].insert(q);
  }
  int expected = 0;
  for (const NodeFront& f : order.fronts) {
    EXPECT_EQ(f.first, expected);
    expected = f.last;
    EXPECT_EQ(f.own, 3 * (f.last - f.first));
    EXPECT_EQ(f.rows, 3 * static_cast<int>(f.below.size()));
    for (int p = f.first; p < f.last; ++p)
      for (const int q : touched[static_cast<size_t>(p)])
        EXPECT_TRUE(q < f.last || std::binary_search(f.below.begin(), f.below.end(), q)) << p << " touches " << q;
  }
  EXPECT_EQ(expected, static_cast<int>(neighbours.size()));
}

TEST(NodeOrder, SubtreesLieSideBySideAndLeadToTheirParents) {
  const auto neighbours = lattice(12, 30);
  const NodeOrder order = order_of(neighbours, std::vector<int>(neighbours.size(), 3));
  const std::vector<int> first = order.subtrees();
  for (size_t k = 0; k < order.fronts.size(); ++k) {
    const NodeFront& f = order.fronts[k];
    if (f.below.empty()) {
      EXPECT_EQ(f.parent, -1);
      continue;
    }
    const NodeFront& parent = order.fronts[static_cast<size_t>(f.parent)];
    EXPECT_TRUE(f.below.front() >= parent.first && f.below.front() < parent.last);
    EXPECT_GT(f.parent, static_cast<int>(k));
    EXPECT_LE(first[static_cast<size_t>(f.parent)], first[k]);
  }
}

TEST(NodeOrder, NodesWithTheSameRowsBelowAreOneFront) {
  std::vector<std::vector<int>> clique(8);
  for (int a = 0; a < 8; ++a)
    for (int b = 0; b < 8; ++b)
      if (a != b) clique[static_cast<size_t>(a)].push_back(b);
  const NodeOrder order = order_of(clique, {1, 2, 3, 4, 5, 6, 7, 8});
  ASSERT_EQ(order.fronts.size(), 1u);
  EXPECT_EQ(order.fronts[0].own, 36);
  const auto chain = lattice(1, 200);
  const NodeOrder of_chain = order_of(chain, std::vector<int>(chain.size(), 100));
  EXPECT_GT(of_chain.fronts.size(), 150u);  // joined they would be full of zeros
}

}  // namespace
}  // namespace swath::calib
