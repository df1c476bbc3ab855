// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/block.h"

#include <gtest/gtest.h>

namespace swath::core {
namespace {

Block two_points() {
  Block b;
  b.x = {1, 2};
  b.y = {3, 4};
  b.z = {5, 6};
  b.return_number = {1, 2};
  return b;
}

TEST(Block, TheListOfColumnsIsWhole) {
  int n = 0;
  for_each_column([&](Column c, std::string_view name, auto) {
    EXPECT_EQ(static_cast<int>(c), n++);
    EXPECT_FALSE(name.empty());
  });
  EXPECT_EQ(static_cast<int>(Column::source), n);
  EXPECT_EQ(n + 1, column_count);
  EXPECT_EQ(name_of(Column::source), "source");
}

TEST(Block, AppendFillsWhatOneSideLacks) {
  Block a = two_points();
  Block b = two_points();
  b.return_number.clear();
  b.intensity = {7, 8};
  append(a, b);
  EXPECT_EQ(a.size(), 4u);
  EXPECT_EQ(a.return_number, (std::vector<std::uint8_t>{1, 2, 0, 0}));
  EXPECT_EQ(a.intensity, (std::vector<std::uint16_t>{0, 0, 7, 8}));
}

TEST(Block, SelectKeepsOrderAndColumns) {
  const Block s = select(two_points(), {1, 0, 1});
  EXPECT_EQ(s.x, (std::vector<double>{2, 1, 2}));
  EXPECT_EQ(s.return_number, (std::vector<std::uint8_t>{2, 1, 2}));
  EXPECT_TRUE(s.intensity.empty());
}

TEST(Block, RowsOfBytesKeepPaceAndWiden) {
  Block a = two_points(), b = two_points();
  a.source = {2, {1, 2, 3, 4}};
  b.source = {3, {5, 6, 7, 8, 9, 10}};
  EXPECT_TRUE(columns_of(a).has(Column::source));
  append(a, b, {1});
  EXPECT_EQ(a.source, (ByteRows{3, {1, 2, 0, 3, 4, 0, 8, 9, 10}}));
  append(a, two_points());
  EXPECT_EQ(a.source.size(), 5u);
  EXPECT_EQ(select(a, {2, 4}).source, (ByteRows{3, {8, 9, 10, 0, 0, 0}}));
  Block c = two_points();
  append(c, b);
  EXPECT_EQ(c.source, (ByteRows{3, {0, 0, 0, 0, 0, 0, 5, 6, 7, 8, 9, 10}}));
  resize(c, 3);
  EXPECT_EQ(c.source.size(), 3u);
}

TEST(Block, ResizeKeepsColumnsInStep) {
  Block b = two_points();
  resize(b, 5);
  EXPECT_EQ(b.return_number.size(), 5u);
  EXPECT_TRUE(b.intensity.empty());
}

}  // namespace
}  // namespace swath::core
