// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/area.h"

#include <gtest/gtest.h>

namespace swath::core {
namespace {

const Area place{{500000, 5400000, 501000, 5401000}};

Block block_of(const std::vector<Eigen::Vector3d>& points) {
  Block b;
  b.origin = {500000.0, 5400000.0, 0.0};
  for (const auto& p : points) {
    b.x.push_back(p.x());
    b.y.push_back(p.y());
    b.z.push_back(p.z());
    b.record.push_back(static_cast<std::uint32_t>(b.record.size() + 70));
  }
  return b;
}

TEST(Area, PointsOutsideAreLeftOutAndCountedWithExamples) {
  Block b = block_of({{0, 0, 300}, {1000, 1000, 300}, {1000.5, 0, 300}, {1e9, 0, 300}, {5, 5, 3e4}, {5, 5, -2e7}});
  Tally tally;
  keep_in_area(place, b, "a.las", tally);
  EXPECT_EQ(b.size(), 2u);
  EXPECT_EQ(tally.left_out(), 4u);
  EXPECT_EQ(tally.of("points outside the survey's area, left out"), 2u);
  EXPECT_EQ(tally.of("points outside the survey's heights, left out"), 2u);
  const Value counts = tally.value();
  EXPECT_EQ(counts.find("points outside the survey's area, left out")->find("examples")->items()[0].as_text(),
            "a.las: record 72: x 501000.5, y 5400000, z 300");
}

TEST(Area, ManyPointsOutsideAreCountedWithTheFirstThree) {
  Block b = block_of(std::vector<Eigen::Vector3d>(50, {1e9, 0, 300}));
  Tally tally;
  keep_in_area(place, b, "a.las", tally);
  const Value counts = tally.value();
  const Value* one = counts.find("points outside the survey's area, left out");
  EXPECT_EQ(one->find("count")->as_int(), 50);
  EXPECT_EQ(one->find("examples")->items().size(), 3u);
}

}  // namespace
}  // namespace swath::core
