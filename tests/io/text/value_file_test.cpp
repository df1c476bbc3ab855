// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/text/value_file.h"

#include "core/error.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

const char* toml_text =
    "name = \"a\"\n"
    "[run]\n"
    "  tile = \"500 m\"\n"
    "[[stage]]\n"
    "type = \"filters.smrf\"\n"
    "slope = 0.15\n"
    "[[stage]]\n"
    "type = \"x\"\n";
const char* json_text =
    "{\"name\": \"a\",\n \"run\": {\n  \"tile\": \"500 m\"},\n \"stage\": [\n {\"type\": \"filters.smrf\",\n \"slope\": 0.15},\n "
    "{\"type\": \"x\"}]}";

TEST(ValueFile, TomlAndJsonAreTheSameTree) {
  const core::Value a = parse_toml(toml_text, "a.toml");
  const core::Value b = parse_json(json_text, "a.json");
  EXPECT_EQ(to_json(a), to_json(b));
  EXPECT_EQ(a.find("run")->find("tile")->where.text(), "a.toml:3:10");
  EXPECT_EQ(b.find("run")->find("tile")->where.line, 3);
  EXPECT_EQ(b.find("stage")->items()[0].find("slope")->where.line, 6);
}

TEST(ValueFile, FaultsNameLineAndColumn) {
  try {
    parse_toml("a = 1\nb = = 2\n", "bad.toml");
    FAIL();
  } catch (const core::Error& e) {
    EXPECT_EQ(e.where().rfind("bad.toml:2:", 0), 0u) << e.text();
    EXPECT_EQ(e.code(), core::Exit::bad_usage);
  }
  try {
    parse_json("{\"a\": 1,\n \"b\" 2}", "bad.json");
    FAIL();
  } catch (const core::Error& e) {
    EXPECT_EQ(e.where().rfind("bad.json:2:", 0), 0u) << e.text();
  }
}

TEST(ValueFile, JsonReadsBackEveryDouble) {
  core::Value v = core::Value::array();
  for (const double d : {0.1, 1e300, -5e-324, 3.0, 12345678901234.5}) v.push(d);
  v.push("quote \" and \\ and \n and \x01");
  const core::Value back = parse_json(to_json(v), "x");
  for (size_t i = 0; i < 5; ++i) EXPECT_EQ(back.items()[i].as_number(), v.items()[i].as_number());
  EXPECT_EQ(back.items()[5].as_text(), v.items()[5].as_text());
}

TEST(ValueFile, MissingFileIsOneClearError) {
  const test::TemporaryFolder folder;
  EXPECT_THROW(read_value_file(folder / "none.toml"), core::Error);
  EXPECT_THROW(read_value_file(folder.path()), core::Error);
}

TEST(ValueFile, JsonThatNestsWithoutEndOrRepeatsAKeyIsRefused) {
  const auto nested = [](size_t n) { return std::string(n, '[') + std::string(n, ']'); };
  EXPECT_NO_THROW(parse_json(nested(200), "x"));
  for (const std::string& text : {nested(201), nested(1000000), std::string("{\"a\": 1, \"b\": 2,\n \"a\": 3}")}) try {
      parse_json(text, "x");
      FAIL();
    } catch (const core::Error& e) {
      EXPECT_EQ(e.code(), core::Exit::bad_usage);
      EXPECT_EQ(e.where().rfind("x:", 0), 0u);
    }
}

TEST(ValueFile, TomlThatNestsWithoutEndIsRefused) {
  std::string dotted = "a";
  for (int i = 0; i < 100000; ++i) dotted += ".a";
  for (const std::string& text : {"x = 1\n" + dotted + " = 1\n", "x = 1\n[" + dotted + "]\n", "x = 1\nv = {" + dotted + " = 1}\n",
                                  "x = 1\nv = " + std::string(100000, '[') + std::string(100000, ']') + "\n"})
    try {
      parse_toml(text, "deep.toml");
      FAIL();
    } catch (const core::Error& e) {
      EXPECT_EQ(e.code(), core::Exit::bad_usage);
      EXPECT_EQ(e.where().rfind("deep.toml:2", 0), 0u) << e.where();
    }
  const std::string dots(1000, '.');
  EXPECT_EQ(parse_toml("a.b.c = \"" + dots + "\" # it's " + dots + "\n", "x").find("a")->find("b")->find("c")->as_text(), dots);
}

TEST(ValueFile, IntegersAbove32BitsStayIntegers) {
  const std::string text = "[4294967296, 9223372036854775807, -9223372036854775808]";
  const core::Value tree = parse_json(text, "x");
  for (const core::Value& v : tree.items()) ASSERT_TRUE(v.is_int());
  EXPECT_EQ(to_json(tree), text + "\n");
  EXPECT_EQ(parse_json("9223372036854775808", "x").as_number(), 9223372036854775808.0) << "what 64 bits do not hold is a number";
}

TEST(ValueFile, NumbersOfJsonAreTheNearestOnes) {
  const auto number = [](const char* text) { return parse_json(text, "x").as_number(); };
  for (const char* zero : {"0e147", "0.0e-999", "1e-400", "0.0000E+77"}) EXPECT_EQ(number(zero), 0.0) << zero;
  EXPECT_EQ(number(("0." + std::string(400, '0') + "1").c_str()), 0.0);
  EXPECT_EQ(number("2.2250738585072011e-308"), 2.2250738585072011e-308);
  EXPECT_EQ(number("123456789012345678901234567890"), 123456789012345678901234567890.0);
  EXPECT_EQ(parse_json("-9223372036854775808", "x").as_int(), std::numeric_limits<std::int64_t>::min());
  EXPECT_EQ(parse_json("-0", "x").as_int(), 0);
  for (const char* large : {"1e400", "-1E+999", "[1, 2e999]"}) EXPECT_THROW(parse_json(large, "x"), core::Error) << large;
  for (const char* wrong : {"01", "1.", ".5", "+1", "1e", "0x1", "NaN", "Infinity"})
    EXPECT_THROW(parse_json(wrong, "x"), core::Error) << wrong;
}

}  // namespace
}  // namespace swath::io
