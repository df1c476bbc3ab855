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
  EXPECT_EQ(n, column_count);
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

TEST(Block, ResizeKeepsColumnsInStep) {
  Block b = two_points();
  resize(b, 5);
  EXPECT_EQ(b.return_number.size(), 5u);
  EXPECT_TRUE(b.intensity.empty());
}

}  // namespace
}  // namespace swath::core
