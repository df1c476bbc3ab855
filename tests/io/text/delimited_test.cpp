// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/text/delimited.h"

#include <cmath>

#include "core/error.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

std::vector<std::vector<double>> read_all(const std::filesystem::path& file, const std::vector<std::string>& columns,
                                          const std::string& delimiter = "") {
  const DelimitedLayout layout = inspect_delimited(file, delimiter);
  std::vector<size_t> at;
  for (const std::string& c : columns) at.push_back(column_of(layout, c, file));
  DelimitedReader reader(file, layout, at);
  std::vector<std::vector<double>> out;
  std::vector<double> row(columns.size());
  while (reader.next(row.data())) out.push_back(row);
  return out;
}

class Delimited : public ::testing::Test {
 protected:
  std::filesystem::path made(const std::string& text) {
    test::write_bytes(folder_ / "a.csv", text);
    return folder_ / "a.csv";
  }
  core::Error error_of(const std::string& text, const std::vector<std::string>& columns) {
    try {
      read_all(made(text), columns);
    } catch (const core::Error& e) {
      return e;
    }
    ADD_FAILURE() << "no error for: " << text;
    return core::Error("none");
  }
  test::TemporaryFolder folder_;
};

using Rows = std::vector<std::vector<double>>;

TEST_F(Delimited, EveryDelimiterGivesTheSameRows) {
  const Rows wanted{{3, 1}, {-6.5, 4}};
  for (const char* text :
       {"t,a,r\n1,2,3\n4,5,-6.5\n", "t;a;r\r\n1;2;3\r\n4;5;-6.5\r\n", "t\ta\tr\n1\t2\t3\n4\t5\t-6.5", "t a  r\n 1   2 3  \n4 5\t-6.5\n",
        "\xEF\xBB\xBFt,a,r\n1,2,3\n\n# remark\n4,5,-6.5", "\"t\",\"a\",\"r\"\n1,\"2\",\"3\"\n4, 5 , -6.5\n",
        "# made by hand\n% t,a,r\n1,2,3\n4,5,-6.5\n", "T,A,R\n+1,2,+3e0\n4,5,-0.65E1\n"})
    EXPECT_EQ(read_all(made(text), {"r", "t"}), wanted) << text;
}

TEST_F(Delimited, ZeroBytesInARecordAreSaidInAMessageWithoutThem) {
  std::string text = "t,a\n";
  for (int k = 0; k < 3000; ++k) text += "1,2\n";  // the first lines are read by another reader
  const core::Error e = error_of(text + "3," + std::string(500, '\0') + "\n4,5\n", {"t", "a"});
  EXPECT_TRUE(e.where().ends_with("a.csv:3002")) << e.where();
  EXPECT_STREQ(e.what(), R"(the line holds zero bytes: '\x00\x00\x00\x00\x00\x00\x00\x00...' in column 'a' is no number)");
  EXPECT_STREQ(error_of("t,a\n1,2\x01\x02\n", {"a"}).what(), R"('2\x01\x02' in column 'a' is no number)");
}

TEST_F(Delimited, CompressedFilesAreToBeUnpacked) {
  EXPECT_STREQ(error_of(std::string("\x1F\x8B\x08\x00\x00 1,2\n", 10), {"1"}).what(), "is compressed by gzip");
  EXPECT_STREQ(error_of("PK\x03\x04 1,2\n", {"1"}).what(), "is compressed by zip");
}

TEST_F(Delimited, ColumnsByNumber) {
  EXPECT_EQ(read_all(made("1,2,3\n4,5,6\n"), {"3", "1", "3"}), (Rows{{3, 1, 3}, {6, 4, 6}}));
  EXPECT_EQ(read_all(made("a,b,c\n4,5,6\n"), {"3"}), (Rows{{6}}));
}

TEST_F(Delimited, NonFiniteAndEmptyFieldsAreHandedOver) {
  const Rows rows = read_all(made("a,b,c\nnan,inf,1\n,-inf,2\n1,2,\n"), {"a", "b", "c"});
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_TRUE(std::isnan(rows[0][0]));
  EXPECT_TRUE(std::isinf(rows[0][1]));
  EXPECT_TRUE(std::isnan(rows[1][0]));
  EXPECT_TRUE(std::isnan(rows[2][2]));
}

TEST_F(Delimited, AMissingColumnIsNamedWithTheNearest) {
  const core::Error e = error_of("time,range,angle\n1,2,3\n", {"rnge"});
  EXPECT_NE(std::string(e.what()).find("time, range, angle"), std::string::npos) << e.text();
  EXPECT_NE(e.hint().find("'range'"), std::string::npos) << e.text();
  EXPECT_NE(e.where().find("a.csv"), std::string::npos);
  error_of("1,2,3\n", {"4"});
  error_of("a,a,b\n1,2,3\n", {"a"});
}

TEST_F(Delimited, BadNumbersAndShortLinesNameTheLine) {
  core::Error e = error_of("a,b\n1,2\n3,x4\n", {"b"});
  EXPECT_EQ(e.where(), (folder_ / "a.csv").string() + ":3");
  EXPECT_NE(std::string(e.what()).find("'x4'"), std::string::npos);
  e = error_of("a,b\n1,2\n\n3\n", {"b"});
  EXPECT_EQ(e.where(), (folder_ / "a.csv").string() + ":4");
  e = error_of("a;b\n1,500;2\n", {"a"});
  EXPECT_NE(e.hint().find("decimals or thousands"), std::string::npos) << e.text();
  error_of("a b\n1 2\n3 4.5.6\n", {"b"});
  EXPECT_NE(error_of("a b\n1 2\n3\n", {"b"}).where().find(":3"), std::string::npos);
}

TEST_F(Delimited, DecimalCommasAreReadBetweenSemicolonsAndTabs) {
  const Rows expected{{12.345, 67.8}, {13.5, 68}};
  EXPECT_EQ(read_all(made("12,345;67,8\n13,5;68\n"), {"1", "2"}), expected);
  EXPECT_EQ(read_all(made("time;range\n12,345;67,8\n13,5;68\n"), {"time", "range"}), expected);
  EXPECT_EQ(read_all(made("Flight of the day\ntime\trange\n12,345\t67,8\n\"13,5\"\t68\n"), {"time", "range"}), expected);
  // Points beside commas may part thousands.
  EXPECT_NE(error_of("time;range\n12,345;67,8\n14,5;1.068\n", {"range"}).hint().find("decimals or thousands"), std::string::npos);
  std::string late = "time;range\n";
  for (int k = 0; k < 60; ++k) late += std::to_string(k) + ",5;67,8\n";
  const core::Error e = error_of(late + "60,5;1.068\n", {"range"});
  EXPECT_NE(e.text().find("a.csv:62: '1.068'"), std::string::npos) << e.text();
  EXPECT_NE(e.hint().find("the numbers above it have decimal commas"), std::string::npos) << e.text();
}

TEST_F(Delimited, AFileThatEndsWithinItsLastLineIsNamed) {
  std::string rows = "t,line,range\n";
  for (int k = 0; k < 12; ++k) rows += "4740" + std::to_string(10 + k) + ".250,1,500.125\n";
  for (const char* cut : {"474022.250,1,500.12", "474022.250,1,50", "474022.250,1,", "474022.250,1", "474022.2", "4740"}) {
    const core::Error e = error_of(rows + cut, {"t"});  // also where the fields that are read are there
    EXPECT_EQ(e.where(), (folder_ / "a.csv").string() + ":14") << cut;
    EXPECT_NE(e.text().find(std::string("the file ends within the line '") + cut + "'"), std::string::npos) << e.text();
    EXPECT_NE(e.hint().find("copy it again"), std::string::npos) << e.hint();
  }
  std::string commas = "t;range\n";
  for (int k = 0; k < 12; ++k) commas += "4740" + std::to_string(10 + k) + ",25;500,125\n";
  EXPECT_NE(error_of(commas + "474022,25;500,1", {"t"}).text().find("the file ends within the line"), std::string::npos);
  // A whole line without a line end, and one of numbers that are written as they come.
  EXPECT_EQ(read_all(made(rows + "474022.250,1,500.125"), {"range"}).size(), 13u);
  EXPECT_EQ(read_all(made(rows + "474022.250,1,500.1\n"), {"range"}).size(), 13u);
  std::string free = rows + "474022.250,1,500.5\n";
  EXPECT_EQ(read_all(made(free + "474023.250,1,7.5"), {"range"}).size(), 14u);
  const core::Error few = error_of("t,range\n1,2\n3", {"range"});
  EXPECT_NE(few.hint().find("copy it again"), std::string::npos) << few.hint();
}

TEST_F(Delimited, LinesWithMoreFieldsThanTheHeaderAreNamed) {
  for (const char* text : {"a,b,c\n1,2,3\n1,2,5,3\n", "1,2,3\n1,2,5,3\n", "a,b,c\n1,2,3,\n1,2,5,3,\n", "a;b;c\n1;2;3\n1;2;x;y\n"}) {
    const core::Error e = error_of(text, {"1"});
    EXPECT_NE(e.where().find("a.csv:"), std::string::npos) << text;
    EXPECT_NE(std::string(e.what()).find("the line has 4 fields"), std::string::npos) << text << e.what();
    EXPECT_NE(e.hint().find("decimal comma"), std::string::npos) << text;
  }
  error_of("a,b\n1,2,5\n", {"b"});
  // Delimiters at the end of lines and in quotes are none of numbers; blanks part no decimal commas.
  EXPECT_EQ(read_all(made("a,b,c\n1,2,3,\n4,5,6\n"), {"a", "b"}), (Rows{{1, 2}, {4, 5}}));
  EXPECT_EQ(read_all(made("a,b,c\n1,2,\"x,y\"\n"), {"a", "b"}), (Rows{{1, 2}}));
  EXPECT_EQ(read_all(made("a b\n1 2 fixed\n3 4\n"), {"a", "b"}), (Rows{{1, 2}, {3, 4}}));
}

/// "ell height" is one column: its name's second word would move all that follows.
TEST_F(Delimited, AHeaderThatDoesNotFitItsDataIsNamed) {
  for (const char* text : {"time lat ell height\n1 2 3\n4 5 6\n", "time,lat, ell,height\n1,2,3\n4,5,6\n", "time lat\n1 2 3\n4 5 6\n"}) {
    const core::Error e = error_of(text, {"lat"});
    EXPECT_NE(e.where().find("a.csv:2"), std::string::npos) << e.text();
    EXPECT_NE(e.text().find("the line has 3 fields"), std::string::npos) << e.text();
    EXPECT_EQ(read_all(made(text), {"3"}), (std::vector<std::vector<double>>{{3}, {6}})) << "numbers need no names";
  }
  EXPECT_EQ(read_all(made("time,lat,note,\n1,2,3\n4,5,6\n"), {"lat"}), (std::vector<std::vector<double>>{{2}, {5}}));
  EXPECT_EQ(read_all(made("time,lat\n1,2,\n4,5,\n"), {"lat"}), (std::vector<std::vector<double>>{{2}, {5}}));
  EXPECT_EQ(read_all(made("time,lat,note\n1,2\n4,5,6\n"), {"lat"}), (std::vector<std::vector<double>>{{2}, {5}})) << "one line is short";
}

TEST_F(Delimited, EmptyFieldsBetweenTabsStayWhereverTheyAre) {
  const auto rows = read_all(made("mark\ttime\tsigma\nA\t1\t0.5\n\t2\t0.5\nC\t3\t\n\t\t\n"), {"time", "sigma"});
  ASSERT_EQ(rows.size(), 3u) << "tabs alone are no record";
  EXPECT_EQ(rows[1], (std::vector<double>{2, 0.5}));
  EXPECT_EQ(rows[2][0], 3.0);
  EXPECT_TRUE(std::isnan(rows[2][1]));
  EXPECT_EQ(read_all(made("\t1 \t 2\n\t3 \t 4\n"), {"2"}, "blank"), (std::vector<std::vector<double>>{{2}, {4}}));
}

TEST_F(Delimited, CommentsMayBeginWithBlanksAndTabs) {
  EXPECT_EQ(read_all(made("\t# one\n  % two\na\tb\n1\t2\n\t# three\n3\t4\n"), {"b"}), (std::vector<std::vector<double>>{{2}, {4}}));
}

TEST_F(Delimited, ARecordThatBeginsWithATextIsNoHeader) {
  const std::string rows = "POS,100,48,ok\nPOS,101,49,ok\nPOS,102,50,ok\n";
  EXPECT_EQ(read_all(made(rows), {"2"}), (std::vector<std::vector<double>>{{100}, {101}, {102}}));
  EXPECT_EQ(read_all(made("kind,time,height,state\n" + rows), {"time"}).size(), 3u);
  EXPECT_EQ(inspect_delimited(made(rows)).data_line, 1u);
}

TEST_F(Delimited, EmptyAndBinaryFilesAreErrors) {
  error_of("", {"1"});
  error_of("a,b\n", {"a"});
  error_of("# only\n", {"1"});
  error_of(std::string("LASF\0\0\0\0", 8), {"1"});
  EXPECT_THROW(inspect_delimited(folder_ / "none.csv"), core::Error);
  EXPECT_THROW(inspect_delimited(made("1,2\n"), "xx"), core::Error);
}

TEST_F(Delimited, EveryTruncationEitherReadsWholeLinesOrNamesTheShortOne) {
  const std::string text = "a,b\n10,20\n30,40\n";
  for (size_t n = 0; n <= text.size(); ++n) {
    const auto file = made(text.substr(0, n));
    try {
      EXPECT_LE(read_all(file, {"a", "b"}).size(), 2u) << n;
    } catch (const core::Error& e) {
      EXPECT_NE(e.where().find("a.csv"), std::string::npos);
    }
  }
}

TEST_F(Delimited, AStretchOfBytesIsReadOnItsOwn) {
  std::string text = "a,b\n";
  for (int i = 0; i < 40000; ++i) text += std::to_string(i) + "," + std::to_string(-i) + "\n";
  const auto file = made(text);
  const DelimitedLayout layout = inspect_delimited(file);
  DelimitedReader all(file, layout, {0, 1});
  double row[2];
  std::uint64_t begin = 0, line = 0, end = 0;
  for (int i = 0; i < 40000; ++i) {
    ASSERT_TRUE(all.next(row));
    ASSERT_EQ(row[0], i);
    ASSERT_EQ(row[1], -i);
    if (i == 20000) begin = all.offset(), line = all.line();
    if (i == 30000) end = all.offset();
  }
  EXPECT_FALSE(all.next(row));
  EXPECT_EQ(line, 20002u);
  DelimitedReader part(file, layout, {0}, begin, line, end);
  int n = 0;
  while (part.next(row)) EXPECT_EQ(row[0], 20000 + n++);
  EXPECT_EQ(n, 10000);
}

TEST(DelimitedReference, RealFiles) {
  SWATH_SHARED_OR_SKIP(data, "data");
  EXPECT_EQ(inspect_delimited(data / "tiny_survey/laser.csv").names.size(), 7u);
  const auto rows = read_all(data / "sbet_houston/sbet_047_IGS08-UTM15N-Ellipsoid-trim.txt", {"GpsTime", "Azimuth"});
  EXPECT_EQ(rows.size(), 14600u);
  EXPECT_EQ(rows.front(), (std::vector<double>{407106.003323, -90.494178}));
}

}  // namespace
}  // namespace swath::io
