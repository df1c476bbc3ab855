// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/grid_tile.h"

#include "core/error.h"
#include "tests/world/support.h"

namespace swath::stages {
namespace {

core::Grid numbered(core::Lattice l) {
  core::Grid g(l);
  g.sigma.resize(l.size());
  for (int j = 0; j < l.ny; ++j)
    for (int i = 0; i < l.nx; ++i) {
      g.height[l.at(i, j)] = static_cast<float>((l.i0 + i) * 1000 + l.j0 + j);
      g.sigma[l.at(i, j)] = 0.5f;
      g.reason[l.at(i, j)] = core::Void::none;
    }
  return g;
}

TEST(GridTile, ReadsBackWhatWasWritten) {
  const test::TemporaryFolder folder;
  const core::Grid g = numbered({2.0, -3, 5, 4, 6});
  write_grid_tile(folder.path(), {1, -2}, g);
  const core::Grid back = read_grid_tile(grid_file(folder.path(), {1, -2}));
  EXPECT_EQ(back.lattice, g.lattice);
  EXPECT_EQ(back.height, g.height);
  EXPECT_EQ(back.sigma, g.sigma);
  EXPECT_TRUE(back.count.empty());
}

TEST(GridTile, ACutFileIsAnError) {
  const test::TemporaryFolder folder;
  write_grid_tile(folder.path(), {0, 0}, numbered({1.0, 0, 0, 3, 3}));
  const std::string bytes = test::read_bytes(grid_file(folder.path(), {0, 0}));
  for (const size_t n : {size_t{0}, size_t{10}, bytes.size() - 1}) {
    test::write_bytes(grid_file(folder.path(), {0, 0}), bytes.substr(0, n));
    EXPECT_THROW(read_grid_tile(grid_file(folder.path(), {0, 0})), core::Error);
  }
}

TEST(GridTile, PastesWhereTheyOverlap) {
  core::Grid window(core::Lattice{1.0, 2, 2, 3, 3});
  paste(numbered({1.0, 0, 0, 4, 4}), window);
  EXPECT_EQ(window.height[0], 2002.0f);
  EXPECT_EQ(window.height[window.lattice.at(1, 1)], 3003.0f);
  EXPECT_EQ(window.reason[window.lattice.at(2, 2)], core::Void::no_data);
  EXPECT_EQ(window.sigma[0], 0.5f);
}

}  // namespace
}  // namespace swath::stages
