// SPDX-License-Identifier: GPL-3.0-or-later
#include "quality/check_marks.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace swath::quality {
namespace {

/// Ground of slope 0.3 to the east at 40 points per m2 of two lines, the second `shift` m higher; every tenth point is vegetation.
core::Block slope(double shift) {
  core::Block b;
  b.origin = {1000, 2000, 50};
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(0, 40);
  for (int k = 0; k < 64000; ++k) {
    const double x = place(random), y = place(random);
    const bool second = k % 2 == 1, plant = k % 10 == 0;
    b.x.push_back(x);
    b.y.push_back(y);
    b.z.push_back(0.3 * x + (second ? shift : 0.0) + (plant ? 2.0 : 0.0));
    b.strip.push_back(second ? 7 : 3);
    b.classification.push_back(plant ? 4 : 2);
    b.flags.push_back(0);
    b.sigma_v.push_back(0.04f);
  }
  return b;
}

CheckMark mark(const std::string& name, double x, double y, double dz = 0.0) {
  return {name, "", "a.csv:1", {1000 + x, 2000 + y, 50 + 0.3 * x + dz}, 0.01};
}

TEST(CheckMarks, EachLineIsReadOnItsOwn) {
  const std::vector<CheckMark> marks{mark("a", 20, 20), mark("b", 10, 30, 0.5)};
  const std::vector<MarkReading> r = read_marks(slope(0.2), marks, {0, 1}, 1.0);
  ASSERT_EQ(r.size(), 4u);
  for (const MarkReading& one : r) {
    const double expected = (one.line == 7 ? 0.2 : 0.0) - (one.mark == 1 ? 0.5 : 0.0);
    EXPECT_NEAR(static_cast<double>(one.difference), expected, 1e-5) << one.mark << " " << one.line;
    EXPECT_NEAR(static_cast<double>(one.slope), 0.3, 1e-5);
    EXPECT_FLOAT_EQ(one.sigma, 0.04f);
    EXPECT_GT(one.points, 4u);
  }
}

TEST(CheckMarks, MarksThatAreNotHereOrHaveNoGroundAreNotRead) {
  const std::vector<CheckMark> marks{mark("a", 20, 20), mark("far", 300, 20)};
  EXPECT_TRUE(read_marks(slope(0), marks, {1}, 1.0).empty());
  EXPECT_EQ(read_marks(slope(0), marks, {0}, 1.0).size(), 2u);
  core::Block plants = slope(0);
  for (auto& c : plants.classification) c = 5;
  EXPECT_TRUE(read_marks(plants, marks, {0}, 1.0).empty());
}

/// Points on one side of a mark make no plane that reaches it: their mean stands.
TEST(CheckMarks, AtARimTheMeanIsTaken) {
  core::Block b = slope(0);
  for (size_t k = 0; k < b.size(); ++k)
    if (b.x[k] < 20.3) b.classification[k] = 1;
  const std::vector<MarkReading> r = read_marks(b, {mark("rim", 20, 20)}, {0}, 1.0);
  ASSERT_FALSE(r.empty());
  const std::vector<MarkReading> mean = read_marks(b, {mark("rim", 20, 20)}, {0}, 1.0, MarkSurface::mean);
  EXPECT_EQ(r[0].difference, mean[0].difference);
  EXPECT_EQ(r[0].slope, 0.0f);
  EXPECT_GT(r[0].difference, 0.1f);
}

}  // namespace
}  // namespace swath::quality
