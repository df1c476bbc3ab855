// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/printable.h"

#include <gtest/gtest.h>

namespace swath::core {
namespace {

TEST(Printable, WhatATerminalCanShowStays) {
  EXPECT_EQ(printable("Zürich, 5\tm\n°µ 測量 \xf0\x9f\x9b\xa9"), "Zürich, 5\tm\n°µ 測量 \xf0\x9f\x9b\xa9");
  EXPECT_EQ(printable(""), "");
}

TEST(Printable, ControlCharactersAndForeignBytesAreWrittenOut) {
  EXPECT_EQ(printable("\x1b[2J\rname\x7f"), "\\x1b[2J\\x0dname\\x7f");
  EXPECT_EQ(printable(std::string_view("a\0b", 3)), "a\\x00b");
  EXPECT_EQ(printable("Z\xfcrich"), "Z\\xfcrich");
  EXPECT_EQ(printable("\xc2\x9b"
                      "2J"),
            "\\xc2\\x9b2J");                                                    // a control sequence in one character
  EXPECT_EQ(printable("\xc0\xaf \xed\xa0\x80"), "\\xc0\\xaf \\xed\\xa0\\x80");  // too long; half of a pair
  EXPECT_EQ(printable("\xe2\x82"), "\\xe2\\x82");                               // cut
  EXPECT_EQ(printable("\xf4\x90\x80\x80"), "\\xf4\\x90\\x80\\x80");             // beyond the last code point
}

TEST(Shortened, LongWordsAndManyLinesAreCut) {
  const std::string usual = "a fault: /some/path/of/a/survey.toml:3:1\n  hint: state it\n";
  EXPECT_EQ(shortened(usual), usual);
  EXPECT_EQ(shortened(""), "");
  const std::string word = "head" + std::string(100000, 'k') + "tail";
  const std::string cut = shortened("key '" + word + "' is not known");
  EXPECT_LT(cut.size(), 300u);
  EXPECT_TRUE(cut.starts_with("key 'head") && cut.ends_with("tail' is not known")) << cut;
  EXPECT_NE(cut.find("characters)"), std::string::npos);
  std::string lines;
  for (int i = 0; i < 1000; ++i) lines += "fault " + std::to_string(i) + "\n";
  EXPECT_TRUE(shortened(lines).ends_with("fault 59\n... and 940 more lines")) << shortened(lines);
}

TEST(CsvField, TextStaysTextInASpreadsheet) {
  EXPECT_EQ(csv_field("roof 7"), "roof 7");
  EXPECT_EQ(csv_field("a,b"), "\"a,b\"");
  EXPECT_EQ(csv_field("5\" disc"), "\"5\"\" disc\"");
  EXPECT_EQ(csv_field("=cmd|' /C calc'!A0"), "'=cmd|' /C calc'!A0");
  EXPECT_EQ(csv_field("@SUM(1,2)"), "\"'@SUM(1,2)\"");
  EXPECT_EQ(csv_field("-1.5"), "-1.5");
  EXPECT_EQ(csv_field("+12"), "+12");
  EXPECT_EQ(csv_field("-2+3"), "'-2+3");
  EXPECT_EQ(csv_field(""), "");
}

TEST(Utf8, OnlyForeignBytesAreWrittenOut) {
  EXPECT_EQ(utf8("\x01ü\xc2\x9b\n"), "\x01ü\xc2\x9b\n");
  EXPECT_EQ(utf8("Z\xfcrich"), "Z\\xfcrich");
}

}  // namespace
}  // namespace swath::core
