// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/text/toml_text.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "io/text/value_file.h"

namespace swath::io {
namespace {

using core::Value;

TEST(TomlText, ReadsBackToTheSameTree) {
  Value v = Value::object();
  v["text"] = "a \"quoted\" \\ back\nnext\tcell \x7f \xc3\xa4";
  v["number"] = 1e-9;
  v["whole"] = 3.0;
  v["integer"] = 42;
  v["yes"] = true;
  v["list"].push("1 m");
  v["list"].push("2 m");
  v["table"]["inner"]["deep"] = 1;
  v["table"]["value"] = 2;
  for (int i = 0; i < 2; ++i) {
    Value row = Value::object();
    row["id"] = i;
    row["part"]["x"] = 0.5;
    v["row"].push(row);
  }
  const Value back = parse_toml(to_toml(v), "made");
  EXPECT_EQ(back.find("text")->as_text(), v.find("text")->as_text());
  EXPECT_EQ(back.find("number")->as_number(), 1e-9);
  EXPECT_FALSE(back.find("whole")->is_int());
  EXPECT_EQ(back.find("integer")->as_int(), 42);
  EXPECT_EQ(back.find("list")->items().size(), 2u);
  EXPECT_EQ(back.find("table")->find("inner")->find("deep")->as_int(), 1);
  EXPECT_EQ(back.find("table")->find("value")->as_int(), 2);
  ASSERT_EQ(back.find("row")->items().size(), 2u);
  EXPECT_EQ(back.find("row")->items()[1].find("part")->find("x")->as_number(), 0.5);
}

TEST(TomlText, RefusesWhatTomlListsCannotHold) {
  Value v = Value::object();
  v["list"].push(1);
  v["list"].push(Value::object());
  EXPECT_THROW(to_toml(v), core::Error);
}

}  // namespace
}  // namespace swath::io
