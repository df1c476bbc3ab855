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
  EXPECT_NO_THROW(lines[0].expect_at_most(2, true));
  EXPECT_THROW(lines[0].expect_at_most(1, true), core::Error);
  test::write_bytes(folder / "a.bin", std::string("a\0b\n", 4));
  EXPECT_THROW(for_each_data_line(folder / "a.bin", delimiter_in, [](DataLine&) {}), core::Error);
}

TEST(DataLines, Utf16IsNamedAndLinesOfTheClassicMacOsAreRead) {
  const test::TemporaryFolder folder;
  for (const std::string& text :
       {std::string("\xFF\xFEn\0,\0x\0\n\0", 10), std::string("\xFE\xFF\0n\0,\0x", 8), std::string("n\0,\0x\0\n\0", 8)}) {
    test::write_bytes(folder / "a.csv", text);
    try {
      for_each_data_line(folder / "a.csv", delimiter_in, [](DataLine&) {});
      FAIL();
    } catch (const core::Error& e) {
      EXPECT_NE(std::string(e.what()).find("UTF-16"), std::string::npos) << e.text();
    }
  }
  test::write_bytes(folder / "a.csv", "name,x\rA,1\rB,2\r");
  std::vector<std::uint64_t> lines;
  for_each_data_line(folder / "a.csv", delimiter_in, [&](DataLine& l) { lines.push_back(l.line + 10 * l.fields.size()); });
  EXPECT_EQ(lines, (std::vector<std::uint64_t>{21, 22, 23}));
}

}  // namespace
}  // namespace swath::io
