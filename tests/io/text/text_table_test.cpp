// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/text/text_table.h"

#include <cmath>

#include "core/error.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

class Tables : public ::testing::Test {
 protected:
  TextTable table(const std::string& text, const std::string& delimiter = {}) {
    test::write_bytes(folder_ / "a.csv", text);
    return TextTable(folder_ / "a.csv", delimiter);
  }
  /// "where: what" of the error, without the folder.
  template <class F>
  std::string fault(const F& f) {
    try {
      f();
    } catch (const core::Error& e) {
      return e.where().substr(e.where().rfind('/') + 1) + ": " + e.what();
    }
    return "no error";
  }
  test::TemporaryFolder folder_;
};

TEST_F(Tables, NamesAndNumbers) {
  const TextTable t = table("\xEF\xBB\xBF# made by hand\n\nname;x;y\r\n\"a;1\"; +1.5 ;2\r\n# between\nb;-3e2;\n");
  ASSERT_EQ(t.rows(), 2u);
  EXPECT_EQ(t.text(0, t.column("NAME")), "a;1");
  EXPECT_EQ(t.number(0, t.column("x")), 1.5);
  EXPECT_EQ(t.number(1, t.column("2")), -300);
  EXPECT_EQ(t.text(1, 2), "");
  EXPECT_TRUE(t.place(1).ends_with("a.csv:6"));
}

TEST_F(Tables, NamesAndWholeNumbersThatMustBeThere) {
  const TextTable t = table("name,strip\nP 1,-7\n,2.5\n");
  EXPECT_EQ(t.name(0, 0, "the image"), "P 1");
  EXPECT_EQ(t.whole_number(0, 1, "the strip"), -7);
  EXPECT_EQ(fault([&] { t.name(1, 0, "the image"); }), "a.csv:3: the image has no name in column 'name'");
  EXPECT_EQ(fault([&] { t.whole_number(1, 1, "the strip"); }), "a.csv:3: the strip is not a whole number: 2.5");
}

TEST_F(Tables, ALineMayEndWithItsDelimiter) {
  const TextTable t = table("name,x\na,1,\nb,2\n");
  ASSERT_EQ(t.rows(), 2u);
  EXPECT_EQ(t.number(0, 1), 1.0);
  EXPECT_EQ(fault([&] { table("name,x\na,1,,\n"); }), "a.csv:2: the line has 4 fields, the header 2 columns");
  EXPECT_EQ(fault([&] { table("name,x\na,1,2\n"); }), "a.csv:2: the line has 3 fields, the header 2 columns");
}

TEST_F(Tables, ColumnsThatNeedNotBeThere) {
  const TextTable t = table("name,x\na,1\n");
  EXPECT_EQ(t.column_if_there("Name", "Name"), 0u);
  EXPECT_FALSE(t.column_if_there("sigma", "sigma"));
  EXPECT_FALSE(t.column_if_there("", "sigma"));
  EXPECT_EQ(fault([&] { t.column_if_there("s", "sigma"); }), "a.csv: no column 's'; columns: name, x");
}

TEST_F(Tables, DecimalCommasAreReadOrNamedAndALetterHasNoNearest) {
  const auto hint = [](const auto& f) {
    try {
      f();
    } catch (const core::Error& e) {
      return e.hint();
    }
    return std::string();
  };
  const TextTable t = table("P;N;E\nP0;650017,093;5\n");
  EXPECT_EQ(t.number(0, 1), 650017.093);
  EXPECT_EQ(t.number(0, 2), 5.0);
  EXPECT_EQ(t.text(0, 1), "650017,093");
  const TextTable doubtful = table("P;N;E\nP0;17,093;5\n");
  EXPECT_EQ(hint([&] { doubtful.number(0, 1); }),
            "does the comma part decimals or thousands? Write decimal points, and nothing between thousands");
  EXPECT_EQ(hint([&] { t.column("x"); }), "name one of the columns, or its number from 1");
}

TEST_F(Tables, FaultsNameTheirLine) {
  EXPECT_EQ(fault([&] { table(""); }), "a.csv: no row of data");
  EXPECT_EQ(fault([&] { table("name,x\n"); }), "a.csv: no row of data");
  EXPECT_EQ(fault([&] { table("name,x\na,1\nb\n"); }), "a.csv:3: the line has 1 field, the header 2 columns");
  const TextTable t = table("name|x\na|nan\nb|\nc|1m\n", "|");
  EXPECT_EQ(fault([&] { t.number(0, 1); }), "a.csv:2: 'nan' is no finite number in column 'x'");
  EXPECT_EQ(fault([&] { t.number(1, 1); }), "a.csv:3: the field is empty in column 'x'");
  EXPECT_EQ(fault([&] { t.number(2, 1); }), "a.csv:4: '1m' is no number in column 'x'");
  EXPECT_EQ(fault([&] { table(std::string("a\0b\n1\n", 6)); }), "a.csv: is not delimited text");
}

TEST_F(Tables, AHeaderThatNeedNotBeThere) {
  const auto any = [&](const std::string& text) {
    test::write_bytes(folder_ / "a.csv", text);
    return TextTable(folder_ / "a.csv", {}, Header::if_any);
  };
  const TextTable bare = any("P1,1.5,2,3\nP2,4,,6\n");
  ASSERT_EQ(bare.rows(), 2u) << "rows of different forms";
  EXPECT_TRUE(bare.names().empty());
  EXPECT_EQ(bare.number(0, bare.column("2")), 1.5);
  EXPECT_EQ(fault([&] { bare.number(1, 2); }), "a.csv:2: the field is empty in column 3");
  EXPECT_TRUE(std::isnan(bare.coordinate(1, 2)));
  EXPECT_EQ(any("P1,1.5,2,3\n").rows(), 1u);
  EXPECT_EQ(any("P1,1.5,2,3,\nP2,4,5,6,\n").columns(), 4u);
  const TextTable described = any("Check points of 2024\nname,x,y,z\n,m,m,m\n1,1,2,3\n2,4,5,6\n");
  EXPECT_EQ(described.rows(), 2u);
  EXPECT_EQ(described.names(), (std::vector<std::string>{"name", "x", "y", "z"}));
  EXPECT_EQ(any("name;x\na;1\n").names().size(), 2u);
  EXPECT_EQ(fault([&] { any("P1,1,2,3\nP2,4,5\n"); }), "a.csv:2: the line has 3 fields, the first line 4 columns");
  EXPECT_EQ(fault([&] { any("name,x\n"); }), "a.csv: no row of data");
}

}  // namespace
}  // namespace swath::io
