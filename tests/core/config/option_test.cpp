// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/config/option.h"

#include <gtest/gtest.h>

namespace swath::core {
namespace {

TEST(Option, RangesSayWhatTheyHold) {
  EXPECT_FALSE(above(0.0).holds(0.0));
  EXPECT_TRUE(at_least(0.0).holds(0.0));
  EXPECT_TRUE(within(0, 5).holds(5));
  EXPECT_EQ(above(0.0).text(Dimension::length), "> 0 m");
  EXPECT_EQ(within(0, 5).text(Dimension::none), "0 to 5");
  EXPECT_EQ(within(0.05, 1.0).text(Dimension::angle), "2.865 deg to 57.29 deg");
  EXPECT_EQ(within(-0.5, 0.1).text(Dimension::angle), "-28.64 deg to 5.729 deg") << "rounded into the range";
  EXPECT_EQ(one_turn().text(Dimension::angle), "-360 deg to 360 deg");
  EXPECT_EQ(within(315964800.0, 1e9).text(Dimension::none), "315964800 to 1e+09") << "large numbers keep their digits";
}

TEST(Option, ScalarsAreReadByTheirShape) {
  std::string fault;
  EXPECT_DOUBLE_EQ(read_scalar(Codec<Metres>::shape(), Value("50 cm"), fault)->as_number(), 0.5);
  EXPECT_FALSE(read_scalar(Codec<Metres>::shape(), Value(1.0), fault));
  EXPECT_NE(fault.find("no unit"), std::string::npos);
  EXPECT_FALSE(read_scalar(Codec<int>::shape(), Value(1.5), fault));
  EXPECT_FALSE(read_scalar(Codec<bool>::shape(), Value(1), fault));
  EXPECT_EQ(Codec<std::vector<int>>::shape().length, 0);
}

}  // namespace
}  // namespace swath::core
