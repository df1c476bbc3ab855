// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/text/data_lines.h"

#include "core/error.h"
#include "io/text/delimited.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

TEST(DataLines, FieldsWithTheirPlaceAndComments) {
  const test::TemporaryFolder folder;
  test::write_bytes(folder / "a.csv", "\xEF\xBB\xBF# of a log\r\n\r\n a, +1.5 \r\n% end\n\"b,c\",nan\nd\n");
  std::vector<DataLine> lines;
  std::string comments;
  for_each_data_line(
      folder / "a.csv", delimiter_in, [&](DataLine& l) { lines.push_back(l); }, [&](const std::string& c) { comments += c + ";"; });
  ASSERT_EQ(lines.size(), 3u);
  EXPECT_EQ(comments, "of a log;end;");
  EXPECT_EQ(lines[0].place, (folder / "a.csv").string() + ":3");
  EXPECT_EQ(lines[0].number(1), 1.5);
  EXPECT_EQ(lines[1].field(0), "b,c");
  EXPECT_EQ(lines[2].line, 6u);
  EXPECT_THROW(lines[1].number(1), core::Error);
  EXPECT_THROW(lines[2].field(1), core::Error);
  test::write_bytes(folder / "a.bin", std::string("a\0b\n", 4));
  EXPECT_THROW(for_each_data_line(folder / "a.bin", delimiter_in, [](DataLine&) {}), core::Error);
}

}  // namespace
}  // namespace swath::io
