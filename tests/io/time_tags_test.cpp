// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/time_tags.h"

#include <gtest/gtest.h>

#include <cmath>

namespace {

using namespace swath;

TEST(TimeTags, UnitsOfAngles) {
  EXPECT_EQ(io::radians_per(io::AngleUnit::unstated), 0.0);
  EXPECT_EQ(io::radians_per(io::AngleUnit::rad), 1.0);
  EXPECT_DOUBLE_EQ(180 * io::radians_per(io::AngleUnit::deg), std::acos(-1.0));
  EXPECT_DOUBLE_EQ(200 * io::radians_per(io::AngleUnit::gon), std::acos(-1.0));
}

}  // namespace
