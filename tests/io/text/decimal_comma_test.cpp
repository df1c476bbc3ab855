// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/text/decimal_comma.h"

#include <gtest/gtest.h>

namespace swath::io {
namespace {

TEST(DecimalComma, DigitsOnBothSidesOfOneComma) {
  for (const char* field : {"12,345", "-0,5", "+1,2e-3", "650017,093"}) EXPECT_TRUE(has_decimal_comma(field)) << field;
  for (const char* field : {"", ",", ",5", "5,", "1,2,3", "1.234,5", "1,234.5", "a,5", "x1,5", "12", "1,5m"})
    EXPECT_FALSE(has_decimal_comma(field)) << field;
  EXPECT_EQ(with_point("-12,345"), "-12.345");
  EXPECT_EQ(with_point("P1, north"), "P1, north");
  EXPECT_EQ(with_points({"1,5", "a"}), (std::vector<std::string>{"1.5", "a"}));
}

TEST(DecimalComma, OnlyWithoutDoubt) {
  EXPECT_TRUE(are_decimal_commas({{"12,345", "67,8"}}, ';'));
  EXPECT_TRUE(are_decimal_commas({{"474009,123", "7"}}, '\t'));
  EXPECT_TRUE(are_decimal_commas({{"P1", "0,123"}}, ';'));
  EXPECT_FALSE(are_decimal_commas({{"12,345", "67,800"}}, ';')) << "may be thousands";
  EXPECT_FALSE(are_decimal_commas({{"12,345", "67,8"}}, ' ')) << "commas may part fields";
  EXPECT_FALSE(are_decimal_commas({{"12,34", "67.8"}}, ';')) << "points are decimal signs, too";
  EXPECT_FALSE(are_decimal_commas({{"12", "67"}}, ';'));
}

}  // namespace
}  // namespace swath::io
