// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/raster/grid_file.h"

#include "core/error.h"
#include "tests/world/support.h"

namespace swath::io {
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

TEST(GridFile, ReadsBackWhatWasWritten) {
  const test::TemporaryFolder folder;
  core::Grid g = numbered({2.0, -3, 5, 4, 6});
  g.reason[3] = core::Void::no_data;
  g.count.assign(g.lattice.size(), 7);
  write_grid_file(folder / "a.grid", g);
  const core::Grid back = read_grid_file(folder / "a.grid");
  EXPECT_EQ(back.lattice, g.lattice);
  EXPECT_EQ(back.height, g.height);
  EXPECT_EQ(back.sigma, g.sigma);
  EXPECT_EQ(back.count, g.count);
  EXPECT_EQ(back.reason, g.reason);
}

TEST(GridFile, ACutFileIsAnError) {
  const test::TemporaryFolder folder;
  write_grid_file(folder / "a.grid", numbered({1.0, 0, 0, 3, 3}));
  const std::string bytes = test::read_bytes(folder / "a.grid");
  for (const size_t n : {size_t{0}, size_t{10}, bytes.size() - 1}) {
    test::write_bytes(folder / "a.grid", bytes.substr(0, n));
    EXPECT_THROW(read_grid_file(folder / "a.grid"), core::Error);
  }
}

}  // namespace
}  // namespace swath::io
