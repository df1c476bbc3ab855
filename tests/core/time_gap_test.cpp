// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/time_gap.h"

#include <gtest/gtest.h>

namespace swath::core {
namespace {

bool names(double apart, const char* word) { return usual_time_gap(apart, 600.0).find(word) != std::string::npos; }

TEST(TimeGap, WeeksDaysAndEpochsAreNamed) {
  EXPECT_TRUE(names(604800.0 + 120.0, "1 week apart"));
  EXPECT_TRUE(names(-3 * 604800.0 - 500.0, "3 weeks apart"));
  EXPECT_TRUE(names(5 * 86400.0 - 30.0, "5 days apart"));
  EXPECT_TRUE(names(1e9 + 1.0, "adjusted"));
  EXPECT_TRUE(names(-315964800.0 - 18.0, "Unix"));
}

TEST(TimeGap, OtherGapsAreNot) {
  EXPECT_EQ(usual_time_gap(0.0, 600.0), "");
  EXPECT_EQ(usual_time_gap(3600.0, 600.0), "");
  EXPECT_EQ(usual_time_gap(1.5 * 86400.0, 600.0), "");
  EXPECT_EQ(usual_time_gap(604800.0, 80000.0), "");
}

}  // namespace
}  // namespace swath::core
