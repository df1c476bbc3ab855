// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/area.h"

#include <gtest/gtest.h>

namespace swath::stages {
namespace {

core::Block block_of(const std::vector<Eigen::Vector3d>& points) {
  core::Block b;
  b.origin = {500000.0, 5400000.0, 0.0};
  for (const auto& p : points) {
    b.x.push_back(p.x());
    b.y.push_back(p.y());
    b.z.push_back(p.z());
    b.record.push_back(static_cast<std::uint32_t>(b.record.size() + 70));
  }
  return b;
}

TEST(Area, PlacesAreGrownAndStatedSidesReplaceThem) {
  io::Survey survey;
  survey.area.west = 499000.0;
  survey.area.highest = core::Metres(900.0);
  Context context{survey};
  set_area(context, {500000, 5400000, 501000, 5401000}, 2000.0);
  EXPECT_EQ(context.area.box.x0, 499000.0);
  EXPECT_EQ(context.area.box.y0, 5398000.0);
  EXPECT_EQ(context.area.box.x1, 503000.0);
  EXPECT_EQ(context.area.highest, 900.0);
}

TEST(Area, PointsOutsideAreLeftOutAndCountedWithExamples) {
  const io::Survey survey;
  Context context{survey};
  set_area(context, {500000, 5400000, 501000, 5401000}, 0.0);
  core::Block b = block_of({{0, 0, 300}, {1000, 1000, 300}, {1000.5, 0, 300}, {1e9, 0, 300}, {5, 5, 3e4}, {5, 5, -2e7}});
  core::Tally tally;
  keep_in_area(context, b, "a.las", tally);
  EXPECT_EQ(b.size(), 2u);
  EXPECT_EQ(tally.left_out(), 4u);
  EXPECT_EQ(tally.of("points outside the survey's area, left out"), 2u);
  EXPECT_EQ(tally.of("points outside the survey's heights, left out"), 2u);
  const core::Value counts = tally.value();
  EXPECT_EQ(counts.find("points outside the survey's area, left out")->find("examples")->items()[0].as_text(),
            "a.las: record 72: x 501000.5, y 5400000, z 300");
}

TEST(Area, ManyPointsOutsideAreCountedWithTheFirstThree) {
  const io::Survey survey;
  Context context{survey};
  set_area(context, {500000, 5400000, 501000, 5401000}, 0.0);
  core::Block b = block_of(std::vector<Eigen::Vector3d>(50, {1e9, 0, 300}));
  core::Tally tally;
  keep_in_area(context, b, "a.las", tally);
  const core::Value counts = tally.value();
  const core::Value* one = counts.find("points outside the survey's area, left out");
  EXPECT_EQ(one->find("count")->as_int(), 50);
  EXPECT_EQ(one->find("examples")->items().size(), 3u);
}

}  // namespace
}  // namespace swath::stages
