// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/images/image_lines.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "core/error.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

TEST(ImageLines, LongLinesCommentsAndLineEnds) {
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "lines.txt";
  const std::string longer(200000, '1');  // beyond the blocks of other readers
  std::ofstream(file, std::ios::binary) << "# comment\r\n\n  \n" << longer << "\r\n a\tb  c\n7";
  ImageLines lines(file);
  std::string_view line;
  ASSERT_TRUE(lines.next_data(line));
  EXPECT_EQ(line.size(), longer.size());
  EXPECT_EQ(lines.number(), 4u);
  ASSERT_TRUE(lines.next_data(line));
  EXPECT_EQ(blank_words(line), (std::vector<std::string_view>{"a", "b", "c"}));
  ASSERT_TRUE(lines.next_data(line));
  EXPECT_EQ(lines.number_in(line, "x"), 7.0);
  EXPECT_EQ(lines.count_in(line, "n"), 7u);
  EXPECT_FALSE(lines.next_data(line));
}

TEST(ImageLines, AByteOrderMarkIsNoPartOfTheFirstName) {
  const test::TemporaryFolder folder;
  const auto first_of = [&](const std::string& text) {
    test::write_bytes(folder / "lines.txt", text);
    ImageLines lines(folder / "lines.txt");
    std::string_view line;
    return lines.next_data(line) ? std::string(line) : std::string();
  };
  EXPECT_EQ(first_of("\xEF\xBB\xBF"
                     "1001\r\n7 1 2\r\n"),
            "1001");
  EXPECT_EQ(first_of("1001\r7 1 2\r"), "1001");  // classic Mac OS
  EXPECT_THROW(first_of(std::string("1\0\n\0", 4)), core::Error);
}

TEST(ImageLines, PixelsAreWholeFromOneToAMillion) {
  EXPECT_EQ(pixel_count(7216.0), 7216);
  EXPECT_EQ(pixel_count(1e6), 1000000);
  for (const double wrong : {0.0, -3.0, 1.5, 1000001.0, 1e300, std::nan("")}) EXPECT_FALSE(pixel_count(wrong)) << wrong;
}

TEST(ImageLines, FaultsNameTheLine) {
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "lines.txt";
  std::ofstream(file) << "1\n1.5x nan -3\n";
  ImageLines lines(file);
  std::string_view line;
  lines.next(line);
  lines.next(line);
  for (const std::string_view word : blank_words(line)) {
    try {
      word == "-3" ? static_cast<void>(lines.count_in(word, "n")) : static_cast<void>(lines.number_in(word, "x"));
      FAIL() << word;
    } catch (const core::Error& e) {
      EXPECT_TRUE(e.where().ends_with("lines.txt:2")) << e.text();
    }
  }
}

TEST(ImageLines, NamesAreNumberedAsTheyCome) {
  std::vector<std::string> names;
  NumberedNames number(names);
  EXPECT_EQ(number("b"), 0u);
  EXPECT_EQ(number("a"), 1u);
  EXPECT_EQ(number("b"), 0u);
  EXPECT_EQ(names, (std::vector<std::string>{"b", "a"}));
}

}  // namespace
}  // namespace swath::io
