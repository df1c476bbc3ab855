// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/dsm.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/terrain/made.h"

namespace swath::terrain {
namespace {

using core::Void;
double crowns(double x, double y) { return 30.0 + 8.0 * std::abs(std::sin(x / 3.0) * std::sin(y / 4.0)); }

TEST(Dsm, HighestFirstReturnOfTheCellWithItsSigma) {
  test::Made m;
  m.add(0.2, 0.2, 10.0, 0.02f);
  m.add(0.7, 0.4, 12.0, 0.05f);
  m.add(0.5, 0.5, 15.0, 0.09f);
  m.block.return_number.back() = 2;
  m.add(0.6, 0.6, 99.0, 0.09f, core::point_class::high_noise);
  m.add(1.5, 0.5, 11.0, 0.03f);
  const core::Lattice window{1.0, 500000, 4600000, 3, 1};
  const core::Grid g = dsm(m.block, window, {});
  EXPECT_EQ(g.height[0], 12.0f);
  EXPECT_EQ(g.sigma[0], 0.05f);
  EXPECT_EQ(g.count[0], 2u);
  EXPECT_EQ(g.height[1], 11.0f);
  EXPECT_EQ(g.reason[2], Void::no_data);
  EXPECT_TRUE(std::isnan(g.height[2]));
}

TEST(Dsm, SmallGapsAreFilledAndWideOnesKept) {
  test::Made m;
  for (int j = 0; j < 30; ++j)
    for (int i = 0; i < 30; ++i) {
      const bool small_gap = i == 5 && j == 5, wide_gap = i >= 12 && i < 22 && j >= 12 && j < 22;
      if (!small_gap && !wide_gap) m.add(i + 0.5, j + 0.5, 20.0 + 0.1 * i);
    }
  const core::Lattice window{1.0, 500000, 4600000, 30, 30};
  const core::Grid g = dsm(m.block, window, {});
  EXPECT_NEAR(static_cast<double>(g.height[window.at(5, 5)]), 20.5, 1e-5);
  EXPECT_EQ(g.count[window.at(5, 5)], 0u);
  EXPECT_EQ(g.sigma[window.at(5, 5)], 0.03f);
  EXPECT_TRUE(std::isnan(g.height[window.at(17, 17)]));
  DsmOptions none;
  none.max_gap = core::Metres(0.0);
  EXPECT_TRUE(std::isnan(dsm(m.block, window, none).height[window.at(5, 5)]));
  DsmOptions wide;
  wide.max_gap = core::Metres(20.0);
  EXPECT_FALSE(std::isnan(dsm(m.block, window, wide).height[window.at(17, 17)]));
  EXPECT_THROW(dsm(m.block, core::Lattice{2.0, 0, 0, 1, 1}, {}), core::Error);
}

TEST(Dsm, SameBitsForEveryTiling) {
  const DsmOptions o;
  const auto random = test::random_points(2500, 60.0, crowns, 3);
  for (const core::Block& b : {random, test::quantised(random, 0.5), test::lattice_points(60, crowns)}) {
    const core::Lattice window{1.0, 499996, 4599996, 68, 68};
    const core::Grid whole = dsm(b, window, o);
    for (const int cells : {9, 25, 40}) {
      const core::Grid t =
          test::tiled(b, window, cells, halo(o), [&](const core::Block& p, const core::Lattice& w) { return dsm(p, w, o); });
      EXPECT_TRUE(test::same_bits(t.height, whole.height)) << cells;
      EXPECT_TRUE(test::same_bits(t.sigma, whole.sigma)) << cells;
      EXPECT_EQ(t.count, whole.count) << cells;
      EXPECT_EQ(t.reason, whole.reason) << cells;
    }
  }
}

}  // namespace
}  // namespace swath::terrain
