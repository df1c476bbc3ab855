// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/measures/level_curve.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"
#include "io/raster/geotiff.h"
#include "tests/world/support.h"

namespace swath::pipeline {
namespace {

TEST(LevelCurve, APitInTheFormOfAConeHoldsWhatItShould) {
  const test::TemporaryFolder folder;
  core::Grid g({0.5, 1200000, 10600000, 120, 120});  // 10 m deep, of radius 20 m, in ground at 100
  const double cx = 600030.0, cy = 5300030.0;
  for (int j = 0; j < 120; ++j)
    for (int i = 0; i < 120; ++i) {
      const double r = std::hypot(g.lattice.centre_x(i) - cx, g.lattice.centre_y(j) - cy);
      g.height[g.lattice.at(i, j)] = static_cast<float>(100.0 - 10.0 * std::max(0.0, 1.0 - r / 20.0));
      g.reason[g.lattice.at(i, j)] = core::Void::none;
    }
  io::write_grid(folder / "pit.tif", g, "EPSG:32632");
  const LevelCurve c = level_curve({folder / "pit.tif", {}, {}, {}, 1.0}, levels_of("90,99,3"));
  ASSERT_EQ(c.rows.size(), 4u);
  EXPECT_EQ(c.rows[0].volume, 0.0);
  for (const LevelRow& r : c.rows) {
    const double h = r.level - 90.0, radius = 2.0 * h;
    EXPECT_NEAR(r.area, M_PI * radius * radius, 0.03 * 400.0);  // cells at the rim
    EXPECT_NEAR(r.volume, M_PI * radius * radius * h / 3.0, 0.01 * M_PI * 400.0 * 10.0 / 3.0);
  }
  EXPECT_NE(level_text(c).find("volume, m3"), std::string::npos);
}

TEST(LevelCurve, LevelsEndAtTheHighest) {
  EXPECT_EQ(levels_of("1,2,0.5"), (std::vector<double>{1.0, 1.5, 2.0}));
  EXPECT_EQ(levels_of("1,2.2,0.5"), (std::vector<double>{1.0, 1.5, 2.0, 2.2}));
  for (const char* bad : {"", "1,2", "1,2,0", "2,1,1", "1,2,3,4", "a,2,1", "1,2,1x", "0,5000,1", "1,nan,1"})
    EXPECT_THROW(levels_of(bad), core::Error) << bad;
}

}  // namespace
}  // namespace swath::pipeline
