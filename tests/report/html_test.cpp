// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/html.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace swath::report {
namespace {

TEST(Html, WhatHtmlWouldReadAsItsOwnIsEscaped) {
  EXPECT_EQ(escaped("a < b && \"c\" > 'd'"), "a &lt; b &amp;&amp; &quot;c&quot; &gt; &#39;d&#39;");
  EXPECT_EQ(escaped("<script>alert(1)</script>"), "&lt;script&gt;alert(1)&lt;/script&gt;");
  EXPECT_EQ(escaped("&lt;"), "&amp;lt;");
  EXPECT_EQ(escaped("Höhe 3 µm – 漢 🛩"), "Höhe 3 µm – 漢 🛩");
}

TEST(Html, ControlCharactersAndDamagedBytesDoNoHarm) {
  EXPECT_EQ(escaped("a\x01\x1b"
                    "b\nc\x7f"),
            "a  b\nc ");
  EXPECT_EQ(escaped("a\xff"
                    "b"),
            "a\uFFFDb");
  EXPECT_EQ(escaped("\xc3"), "\uFFFD");
  EXPECT_EQ(escaped("\xed\xa0\x80"), "\uFFFD");      // half of a surrogate pair
  EXPECT_EQ(escaped("\xf7\xbf\xbf\xbf"), "\uFFFD");  // beyond Unicode
}

TEST(Html, Base64OfRfc4648) {
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foob"), "Zm9vYg==");
  EXPECT_EQ(base64("fooba"), "Zm9vYmE=");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64(std::string("\0\xff\xfe", 3)), "AP/+");
}

TEST(Html, NumbersAsAPageShowsThem) {
  EXPECT_EQ(number_text(1.25, 1), "1.2");  // to even, as the digits of a double fall
  EXPECT_EQ(number_text(-3.14159, 3), "−3.142");
  EXPECT_EQ(number_text(-0.0004, 2), "0.00");
  EXPECT_EQ(number_text(9999.0, 0), "9999");
  EXPECT_EQ(number_text(-12345.678, 1), "−12\u202F345.7");
  EXPECT_EQ(number_text(1234567.0, 0), "1\u202F234\u202F567");
  EXPECT_EQ(number_text(std::nan(""), 2), "–");
  EXPECT_EQ(number_text(std::numeric_limits<double>::infinity(), 2), "–");
  EXPECT_EQ(count_text(20000000), "20\u202F000\u202F000");
  EXPECT_EQ(count_text(0), "0");
}

}  // namespace
}  // namespace swath::report
