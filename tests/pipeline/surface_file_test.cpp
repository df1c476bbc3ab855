// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/surface_file.h"

#include <gtest/gtest.h>

#include "io/raster/geotiff.h"
#include "tests/world/support.h"

namespace swath::pipeline {
namespace {

TEST(SurfaceFile, SigmaIsFoundBesideTheHeights) {
  const test::TemporaryFolder folder;
  core::Grid g(core::Lattice{1.0, 600000, 5300000, 12, 9});
  std::fill(g.height.begin(), g.height.end(), 412.0f);
  std::fill(g.reason.begin(), g.reason.end(), core::Void::none);
  io::write_grid(folder / "dtm.tif", g, "EPSG:25832+7837");
  EXPECT_TRUE(read_surface(folder / "dtm.tif").grid.sigma.empty());
  g.sigma.assign(g.lattice.size(), 0.05f);
  g.count.assign(g.lattice.size(), 3);
  io::write_grid(folder / "dtm_quality.tif", g, "EPSG:25832+7837", io::quality_bands);
  const SurfaceFile whole = read_surface(folder / "dtm.tif");
  EXPECT_EQ(whole.grid.sigma, g.sigma);
  EXPECT_EQ(whole.grid.height, g.height);
  EXPECT_EQ(whole.crs.epsg(), 25832);
  const core::Lattice part{1.0, 600003, 5300002, 4, 5};
  EXPECT_EQ(read_surface(folder / "dtm.tif", part).grid.sigma.size(), 20u);
}

}  // namespace
}  // namespace swath::pipeline
