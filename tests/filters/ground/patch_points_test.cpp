// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/ground/patch_points.h"

#include <gtest/gtest.h>

namespace swath::filters {
namespace {

/// A square of 10 m at (100, 200) with a margin of 10 m, whole to 2 m around it; cells of 2 m.
constexpr PatchThinning thinning{2.0, 2.0, 15};

struct Made {
  core::Block b;
  Patch patch{100.0, 200.0, 10.0, {}};
  void add(double x, double y, double z) {
    b.x.push_back(x), b.y.push_back(y), b.z.push_back(z);
    patch.rows.push_back(static_cast<std::uint32_t>(patch.rows.size()));
  }
  PatchPoints taken() const { return {b, patch, {90.0, 190.0, 0.0}, thinning}; }
};

TEST(PatchPoints, BehindTheWholeMarginTheLowestOfEachCellIsLeft) {
  Made m;
  m.add(91.0, 191.0, 5.0);
  m.add(91.5, 191.5, 4.0);  // the lowest of its cell
  m.add(93.0, 191.0, 9.0);  // alone in the next one
  m.add(98.5, 205.0, 7.0);  // within the whole margin
  m.add(98.6, 205.0, 6.0);
  m.add(105.0, 205.0, 3.0);
  m.add(105.1, 205.0, 8.0);
  const PatchPoints p = m.taken();
  EXPECT_EQ(p.point_of_row, (std::vector<std::uint32_t>{PatchPoints::none, 0, 1, 2, 3, 4, 5}));
  ASSERT_EQ(p.points.size(), 6u);
  EXPECT_EQ(p.points[0], Eigen::Vector3d(1.5, 1.5, 4.0));
  EXPECT_TRUE(p.points[5].isApprox(Eigen::Vector3d(15.1, 15.0, 8.0)));
}

TEST(PatchPoints, OfPointsAtOnePlaceTheLowestStandsForAll) {
  Made m;
  m.add(105.0, 205.0, 3.0);
  m.add(105.0, 205.0, 8.0);
  m.add(105.0, 206.0, 1.0);
  const PatchPoints p = m.taken();
  EXPECT_EQ(p.point_of_row, (std::vector<std::uint32_t>{0, 0, 1}));
  ASSERT_EQ(p.points.size(), 2u);
  EXPECT_EQ(p.points[0].z(), 3.0);
}

}  // namespace
}  // namespace swath::filters
