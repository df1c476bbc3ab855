// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/text/fields.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"

namespace swath::io {
namespace {

using Fields = std::vector<std::string>;

TEST(Fields, OfALine) {
  EXPECT_EQ(split_delimited(" a ,\"b, c\", 3 ", ','), (Fields{"a", "b, c", "3"}));
  EXPECT_EQ(split_delimited("\ta  b\tc ", ' '), (Fields{"a", "b", "c"}));
  EXPECT_EQ(split_delimited("\t2\t", '\t'), (Fields{"", "2", ""})) << "empty fields at either end stay";
  EXPECT_EQ(split_delimited(",2,", ','), (Fields{"", "2", ""}));
}

TEST(Fields, TheDelimiterIsFoundOrStated) {
  EXPECT_EQ(delimiter_in("1\t2;3"), '\t');
  EXPECT_EQ(delimiter_in("1;2,3"), ';');
  EXPECT_EQ(delimiter_in("\t1 2"), ' ') << "a tab in front parts nothing";
  EXPECT_EQ(delimiter_from("tab", "a.csv"), '\t');
  EXPECT_EQ(delimiter_from("blank", "a.csv"), ' ');
  EXPECT_THROW(delimiter_from("xx", "a.csv"), core::Error);
}

TEST(Fields, Numbers) {
  const auto number = [](const std::string& text) {
    double v = -1.0;
    return fields::parse_number(text.data(), text.data() + text.size(), v) ? v : -1.0;
  };
  EXPECT_EQ(number(" +2.5 "), 2.5);
  EXPECT_EQ(number("\"7\""), 7.0);
  EXPECT_EQ(number("1e-400"), 0.0);
  EXPECT_TRUE(std::isnan(number("")));
  EXPECT_EQ(number("2,5"), -1.0);
}

}  // namespace
}  // namespace swath::io
