// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/text/text_faults.h"

#include <gtest/gtest.h>

#include "core/error.h"

namespace swath::io {
namespace {

std::string hint(const char* field) { return number_hint(field, "otherwise"); }

TEST(TextFaults, HintsByWhatAFieldHolds) {
  EXPECT_NE(hint("12,345").find("decimals or thousands"), std::string::npos);
  EXPECT_NE(hint("1.234,5").find("write decimal points"), std::string::npos);
  EXPECT_NE(hint("12:30:05").find("times of day"), std::string::npos);
  EXPECT_NE(hint("47 54 23.1").find("decimal degrees"), std::string::npos);
  EXPECT_EQ(hint("x4"), "otherwise");
}

TEST(TextFaults, FieldsAreCountedInWords) {
  EXPECT_EQ(fields_and_columns(1, 2, true), "the line has 1 field, the header 2 columns");
  EXPECT_EQ(fields_and_columns(3, 1, false), "the line has 3 fields, the first line 1 column");
}

TEST(TextFaults, WhatIsNoTextIsRefusedWithItsKind) {
  const auto fault = [](std::string_view begin) {
    try {
      require_text(begin, "a.csv");
    } catch (const core::Error& e) {
      return e.text();
    }
    return std::string();
  };
  EXPECT_EQ(fault("1,2\n"), "");
  EXPECT_NE(fault("\x1F\x8B..").find("compressed by gzip"), std::string::npos);
  EXPECT_TRUE(is_packed("PK\x03\x04"));
  EXPECT_FALSE(is_packed("1,2"));
  EXPECT_NE(fault("\xFF\xFE"
                  "1")
                .find("UTF-16"),
            std::string::npos);
  EXPECT_NE(fault(std::string_view("1,\0\0\0x", 6)).find("is not delimited text"), std::string::npos);
}

}  // namespace
}  // namespace swath::io
