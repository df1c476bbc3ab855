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

TEST(Utf8, OnlyForeignBytesAreWrittenOut) {
  EXPECT_EQ(utf8("\x01ü\xc2\x9b\n"), "\x01ü\xc2\x9b\n");
  EXPECT_EQ(utf8("Z\xfcrich"), "Z\\xfcrich");
}

}  // namespace
}  // namespace swath::core
