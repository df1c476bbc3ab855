// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/las/las_extras.h"

#include "tests/io/las_sample.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

std::vector<LasVlr> one_record(const std::vector<LasExtra>& extras) { return with_extras({}, extras); }

TEST(LasExtras, FieldsComeBackAsDescribed) {
  const std::vector<LasExtra> made = test::sample_header(6, -1, true).extras;
  std::vector<std::string> warnings;
  int bytes = 0;
  for (const LasExtra& e : made) bytes += e.size();
  const std::vector<LasExtra> read = extras_of(one_record(made), {}, bytes, warnings);
  EXPECT_TRUE(warnings.empty());
  ASSERT_EQ(read.size(), made.size());
  for (std::size_t i = 0; i < made.size(); ++i) {
    EXPECT_EQ(read[i].name, made[i].name);
    EXPECT_EQ(read[i].type, made[i].type);
    EXPECT_EQ(read[i].nodata, made[i].nodata);
    EXPECT_EQ(read[i].scale, made[i].scale);
  }
}

TEST(LasExtras, SeveralRecordsAreReadAndStay) {
  std::vector<LasVlr> two = one_record({test::extra_field("deviation", 3)});
  const std::vector<LasVlr> second = one_record({test::extra_field("confidence", 1)});
  two.push_back({"vendor", 1, "between", {1, 2}, 0, 2});
  two.push_back(second[0]);
  std::vector<std::string> warnings;
  std::vector<LasExtra> extras = extras_of(two, {}, 4, warnings);
  ASSERT_EQ(extras.size(), 3u);
  EXPECT_EQ(extras[1].name, "confidence");
  EXPECT_EQ(extras[2].type, 0);  // the byte that no record describes
  const std::vector<LasVlr> same = with_extras(two, extras);
  ASSERT_EQ(same.size(), 3u);
  EXPECT_EQ(same[2].data, second[0].data);
  extras.pop_back();
  extras.push_back(test::extra_field("height", 9));
  const std::vector<LasVlr> more = with_extras(two, extras);
  ASSERT_EQ(more.size(), 2u);
  EXPECT_EQ(more[0].data.size(), 3u * 192u);
  EXPECT_EQ(more[1].user_id, "vendor");
  EXPECT_EQ(with_extras(two, {}).size(), 1u);
}

TEST(LasExtras, WhatDoesNotFitTheRecordsIsNamed) {
  std::vector<std::string> warnings;
  EXPECT_EQ(extras_of(one_record({test::extra_field("a", 5), test::extra_field("b", 10)}), {}, 6, warnings).size(), 2u);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("'b'"), std::string::npos);
}

}  // namespace
}  // namespace swath::io
