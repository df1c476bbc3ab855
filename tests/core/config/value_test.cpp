// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/config/value.h"

#include <gtest/gtest.h>

namespace swath::core {
namespace {

TEST(Value, KeepsOrderAndFinds) {
  Value v;
  v["b"] = 1;
  v["a"] = "text";
  v["list"].push(2.5);
  ASSERT_EQ(v.members().size(), 3u);
  EXPECT_EQ(v.members()[0].first, "b");
  EXPECT_EQ(v.find("a")->as_text(), "text");
  EXPECT_EQ(v.find("list")->items()[0].as_number(), 2.5);
  EXPECT_EQ(v.find("missing"), nullptr);
  EXPECT_EQ(v.kind(), "table");
}

TEST(Value, NearestKnowsTyposAndRefusesTheFar) {
  const std::vector<std::string> keys = {"cell", "slope", "window", "lever_arm_scanner"};
  EXPECT_EQ(nearest("slop", keys), "slope");
  EXPECT_EQ(nearest("widnow", keys), "window");
  EXPECT_EQ(nearest("lever_arm", keys), "");
  EXPECT_EQ(nearest("zzz", keys), "");
}

}  // namespace
}  // namespace swath::core
