// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/classes/crowns.h"

#include <gtest/gtest.h>

namespace swath::filters {
namespace {

/// Returns of a roof 6 m high west of x = 0, of a crown 3 to 7 m high east of it, and one that is asked about, the last.
struct Place {
  core::Block block;
  std::vector<Witness> witness;

  void add(double x, double y, double z, Witness w) {
    block.x.push_back(x), block.y.push_back(y), block.z.push_back(z);
    witness.push_back(w);
  }
  Place(double x, double z, bool crown) {
    for (double y = -4.0; y <= 4.0; y += 0.5)
      for (double u = 0.0; u < 5.0; u += 0.5) {
        add(-u, y, 6.0, Witness::roof);
        for (double v = 3.0; crown && v <= 7.0; v += 1.0) add(u + 0.25, y, v, Witness::crown);
      }
    add(x, 0.0, z, Witness::none);
  }
  bool is_crown() const { return Crowns(block, witness).holds(block.size() - 1); }
};

TEST(Crowns, WallsAndWhatStandsOnARoofAreNone) {
  EXPECT_FALSE(Place(0.2, 4.5, false).is_crown());
  EXPECT_FALSE(Place(-1.5, 4.0, true).is_crown());  // its roof is above it
  EXPECT_FALSE(Place(-2.5, 6.8, true).is_crown());
}

TEST(Crowns, ABranchBesideARoofIsOne) {
  EXPECT_TRUE(Place(1.0, 5.5, true).is_crown());
  EXPECT_TRUE(Place(1.5, 4.0, true).is_crown());
}

}  // namespace
}  // namespace swath::filters
