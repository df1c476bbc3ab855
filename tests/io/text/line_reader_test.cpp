// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/text/line_reader.h"

#include <cmath>

#include "tests/world/support.h"

namespace swath::io {
namespace {

TEST(LineReader, LinesOfAnyLengthAndContent) {
  const test::TemporaryFolder folder;
  const std::string long_line(200000, 'x'), zeros(300, '\0');
  test::write_bytes(folder / "a", "one\r\n\n" + zeros + "\ntwo" + long_line + "\nlast");
  LineReader lines(folder / "a");
  std::string_view line;
  ASSERT_TRUE(lines.next(line));
  EXPECT_EQ(line, "one");
  ASSERT_TRUE(lines.next(line));
  EXPECT_EQ(line, "");
  ASSERT_TRUE(lines.next(line));
  EXPECT_EQ(line.size(), zeros.size());
  EXPECT_EQ(lines.place(), (folder / "a").string() + ":3");
  size_t length = 0;
  std::string_view end;
  while (lines.next(line)) {
    length += line.size();
    end = line;
  }
  EXPECT_EQ(length, 3 + long_line.size() + 4);
  EXPECT_EQ(end, "last");
  test::write_bytes(folder / "empty", "");
  EXPECT_FALSE(LineReader(folder / "empty").next(line));
}

TEST(LineReader, WordsAndNumbers) {
  EXPECT_EQ(words_of(" a, b;;c\td ").size(), 4u);
  EXPECT_TRUE(words_of(" ,").empty());
  double v = 0;
  EXPECT_TRUE(read_number("+1.5", v));
  EXPECT_EQ(v, 1.5);
  EXPECT_TRUE(read_number("-0", v));
  EXPECT_TRUE(std::signbit(v));
  EXPECT_FALSE(read_number("1.5x", v));
  EXPECT_FALSE(read_number("", v));
}

}  // namespace
}  // namespace swath::io
