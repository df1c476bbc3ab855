// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/survey/time_tags.h"

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

TEST(TimeTags, EveryOptionReachesTheReader) {
  io::TimeTags tags;
  tags.scale = core::TimeScale::device;
  tags.unit = core::Seconds(0.001);
  tags.origin = "1980-01-06T00:01:40 GPS";
  tags.origin_at = 1000;
  tags.offset = core::Seconds(0.25);
  EXPECT_DOUBLE_EQ(io::reader_of(tags, "a")(3000), 102.25);
  EXPECT_DOUBLE_EQ(io::reader_of(tags, "a", true).in_week(1, 3000), 604803.25);
  tags = {core::TimeScale::gps_week, 2, ""};
  EXPECT_EQ(io::reader_of(tags, "a")(5), 2 * 604800.0 + 5);
  tags = {core::TimeScale::utc_day, {}, "1980-01-07"};
  EXPECT_EQ(io::reader_of(tags, "a")(5), 86405);
}

}  // namespace
