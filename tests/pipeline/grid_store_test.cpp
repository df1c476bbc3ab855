// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/grid_store.h"

#include <fstream>

#include "core/error.h"
#include "tests/world/support.h"

namespace swath::pipeline {
namespace {

TEST(GridStore, AWindowIsPutTogetherFromTiles) {
  const test::TemporaryFolder folder;
  const double side = 10.0, cell = 3.0;  // no multiple: cells go to the tile that holds their centre
  for (int iy = 0; iy < 3; ++iy)
    for (int ix = 0; ix < 3; ++ix) {
      core::Grid g(stages::lattice_in(cell, {ix * side, iy * side, (ix + 1) * side, (iy + 1) * side}));
      for (int j = 0; j < g.lattice.ny; ++j)
        for (int i = 0; i < g.lattice.nx; ++i) {
          g.height[g.lattice.at(i, j)] = static_cast<float>(100 * (g.lattice.i0 + i) + g.lattice.j0 + j);
          g.reason[g.lattice.at(i, j)] = core::Void::none;
        }
      stages::write_grid_tile(folder.path(), {ix, iy}, g);
    }
  // A process that was killed, or is at work, has begun a tile.
  std::ofstream(folder.path() / ".part-1-0-0_0.grid") << "swgrid";
  GridStore store(side);
  store.add(stages::Product::dtm, folder.path());
  EXPECT_EQ(store.cell(stages::Product::dtm), cell);
  const core::Grid w = store.window(stages::Product::dtm, {cell, 1, 1, 8, 8});
  for (int j = 0; j < 8; ++j)
    for (int i = 0; i < 8; ++i) EXPECT_EQ(w.height[w.lattice.at(i, j)], static_cast<float>(100 * (1 + i) + 1 + j));
  EXPECT_THROW(store.cell(stages::Product::dsm), core::Error);
  std::filesystem::remove(stages::grid_file(folder.path(), {1, 1}));
  EXPECT_THROW(store.window(stages::Product::dtm, {cell, 1, 1, 8, 8}), core::Error) << "a tile that is gone is no void";
}

}  // namespace
}  // namespace swath::pipeline
