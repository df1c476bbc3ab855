// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/tin/spike_free.h"

#include <gtest/gtest.h>

#include <random>

#include "terrain/dsm.h"
#include "tests/terrain/made.h"

namespace swath::terrain {
namespace {

/// A crown of 12 m through which every fifth pulse finds its way to the ground.
core::Block crown() {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(0.0, 60.0);
  test::Made m;
  for (int k = 0; k < 40000; ++k) {
    const double x = place(random), y = place(random), r = std::hypot(x - 30.0, y - 30.0);
    const double top = r < 15.0 ? 12.0 - 0.02 * r * r : 0.0;
    m.add(x, y, k % 5 == 0 ? 0.0 : top);
  }
  return m.block;
}

TEST(SpikeFree, PulsesThroughTheCrownLeaveNoPits) {
  const core::Block b = crown();
  const core::Lattice window{0.25, 2000080, 18400080, 80, 80};  // 20 to 40 m: all crown
  DsmOptions o;
  o.cell = core::Metres(0.25);
  const auto pits = [&](const core::Grid& g) {
    int n = 0;
    for (int j = 0; j < window.ny; ++j)
      for (int i = 0; i < window.nx; ++i) {
        const double r = std::hypot(window.centre_x(i) - b.origin.x() - 30.0, window.centre_y(j) - b.origin.y() - 30.0);
        n += !(std::abs(static_cast<double>(g.height[window.at(i, j)]) - (12.0 - 0.02 * r * r)) < 0.5);
      }
    return n;
  };
  EXPECT_GT(pits(dsm(b, window, o)), 100);
  o.method = SurfaceMethod::spike_free;
  o.spike_free.freeze = core::Metres(1.5);  // random pulses: some triangles of the crown have edges over a metre
  EXPECT_LE(pits(dsm(b, window, o)), 5);
}

TEST(SpikeFree, EdgesOfTheCrownStaySharp) {
  const core::Block b = crown();
  const core::Lattice window{0.5, 1000000, 9200000, 120, 120};
  DsmOptions o;
  o.cell = core::Metres(0.5);
  o.method = SurfaceMethod::spike_free;
  const core::Grid g = dsm(b, window, o);
  for (int j = 0; j < window.ny; ++j)
    for (int i = 0; i < window.nx; ++i) {
      const double r = std::hypot(window.centre_x(i) - b.origin.x() - 30.0, window.centre_y(j) - b.origin.y() - 30.0);
      if (r > 16.5 && g.reason[window.at(i, j)] == core::Void::none) {
        EXPECT_LT(g.height[window.at(i, j)], 0.1f);
      }
    }
}

TEST(SpikeFree, SameBitsForEveryTiling) {
  const core::Block b = test::quantised(crown(), 0.01);
  const core::Lattice window{1.0, 500000, 4600000, 60, 60};
  DsmOptions o;
  o.method = SurfaceMethod::spike_free;
  const core::Grid whole = dsm(b, window, o);
  for (const int cells : {13, 31}) {
    const core::Grid t = test::tiled(b, window, cells, halo(o), [&](const core::Block& p, const core::Lattice& w) { return dsm(p, w, o); });
    EXPECT_TRUE(test::same_bits(t.height, whole.height)) << cells;
    EXPECT_EQ(t.reason, whole.reason) << cells;
  }
}

}  // namespace
}  // namespace swath::terrain
