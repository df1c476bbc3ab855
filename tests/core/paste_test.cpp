// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/paste.h"

#include <gtest/gtest.h>

namespace swath::core {
namespace {

Grid numbered(Lattice l) {
  Grid g(l);
  g.sigma.resize(l.size());
  for (int j = 0; j < l.ny; ++j)
    for (int i = 0; i < l.nx; ++i) {
      g.height[l.at(i, j)] = static_cast<float>((l.i0 + i) * 1000 + l.j0 + j);
      g.sigma[l.at(i, j)] = 0.5f;
      g.reason[l.at(i, j)] = Void::none;
    }
  return g;
}

TEST(Paste, PastesWhereTheyOverlap) {
  Grid window(Lattice{1.0, 2, 2, 3, 3});
  paste(numbered({1.0, 0, 0, 4, 4}), window);
  EXPECT_EQ(window.height[0], 2002.0f);
  EXPECT_EQ(window.height[window.lattice.at(1, 1)], 3003.0f);
  EXPECT_EQ(window.reason[window.lattice.at(2, 2)], Void::no_data);
  EXPECT_EQ(window.sigma[0], 0.5f);
}

TEST(Paste, KnownPartHasOneCellMore) {
  Grid g(Lattice{0.5, 100, 200, 30, 20});
  EXPECT_EQ(known_part(g).size(), 0u);
  g.height[g.lattice.at(10, 4)] = g.height[g.lattice.at(12, 19)] = 1.0F;
  EXPECT_EQ(known_part(g), (Lattice{0.5, 109, 203, 5, 17})) << "not beyond the grid's own northern rim";
}

TEST(Paste, CommonPart) {
  EXPECT_EQ(common_part({1.0, 0, 0, 4, 4}, {1.0, 2, -1, 9, 3}), (Lattice{1.0, 2, 0, 2, 2}));
  EXPECT_EQ(common_part({1.0, 0, 0, 4, 4}, {1.0, 7, 0, 9, 3}).size(), 0u);
}

}  // namespace
}  // namespace swath::core
