// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/contours/map_class.h"

#include <gtest/gtest.h>

namespace swath::terrain {
namespace {

TEST(MapClass, TheDecreesShares) {
  // PEC (9 of 10 heights) is 1.6449 standard errors: 1/2, 3/5, 3/4 of the interval to the decree's rounding.
  constexpr double nine_of_ten = 1.6449;
  EXPECT_NEAR(map_classes[0].standard_error * nine_of_ten, 0.5, 0.05);
  EXPECT_NEAR(map_classes[1].standard_error * nine_of_ten, 0.6, 0.06);
  EXPECT_NEAR(map_classes[2].standard_error * nine_of_ten, 0.75, 0.075);
}

TEST(MapClass, BestClassKept) {
  EXPECT_EQ(map_class_of(1.0, 0.10), 'A');
  EXPECT_EQ(map_class_of(0.3, 0.10), 'A');
  EXPECT_EQ(map_class_of(0.29, 0.10), 'B');
  EXPECT_EQ(map_class_of(0.25, 0.10), 'B');
  EXPECT_EQ(map_class_of(0.24, 0.10), 'C');
  EXPECT_EQ(map_class_of(0.2, 0.10), 'C');
  EXPECT_EQ(map_class_of(0.19, 0.10), '-');
}

TEST(MapClass, SmallestAndUsualIntervals) {
  EXPECT_NEAR(smallest_interval(map_classes[0], 0.15), 0.45, 1e-12);
  EXPECT_DOUBLE_EQ(usual_interval(0.45), 0.5);
  EXPECT_DOUBLE_EQ(usual_interval(0.3), 0.5);
  EXPECT_DOUBLE_EQ(usual_interval(0.25), 0.25);
  EXPECT_DOUBLE_EQ(usual_interval(0.5), 0.5);
  EXPECT_DOUBLE_EQ(usual_interval(6.0), 10.0);
  EXPECT_DOUBLE_EQ(usual_interval(1.0), 1.0);
}

}  // namespace
}  // namespace swath::terrain
