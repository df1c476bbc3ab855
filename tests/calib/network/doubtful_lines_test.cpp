// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/network/doubtful_lines.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace swath::calib {
namespace {

constexpr size_t knots = 15;
const std::vector<TieLine> lines = {{1, 0.0, 14.0}, {2, 100.0, 114.0}, {7, 200.0, 214.0}};

/// Changes of all lines as large as the sigmas say, alike along a line: before 3 cm and 0.3 mrad, after 2 cm and 0.1 mrad.
std::vector<LineCorrection> drawn(std::mt19937& random) {
  std::normal_distribution<double> normal;
  std::vector<LineCorrection> out;
  for (const TieLine& l : lines) {
    LineCorrection c;
    c.line = l.id;
    std::array<double, 6> before{}, after{}, value{};
    for (size_t k = 0; k < 6; ++k) {
      before[k] = k < 3 ? 0.03 : 3e-4, after[k] = k < 3 ? 0.02 : 1e-4;
      value[k] = std::sqrt(before[k] * before[k] - after[k] * after[k]) * normal(random);
    }
    for (size_t i = 0; i < knots; ++i) {
      c.time.push_back(l.first + static_cast<double>(i));
      c.value.push_back(value), c.sigma.push_back(after), c.apriori.push_back(before);
    }
    out.push_back(c);
  }
  return out;
}

/// `count` groups of each line, the first `without` of `line` (a place) without weight.
std::vector<GroupResidual> groups_of(size_t count, std::uint32_t line, size_t without) {
  std::vector<GroupResidual> out;
  for (std::uint32_t l = 0; l < lines.size(); ++l)
    for (size_t g = 0; g < count; ++g) {
      GroupResidual r;
      r.line = l;
      r.rejected = l == line && g < without;
      out.push_back(r);
    }
  return out;
}

TEST(DoubtfulLines, ChangesAsLargeAsTheSigmasSayAreNone) {
  std::mt19937 random(1);
  int alarms = 0;
  constexpr int surveys = 5000;
  for (int i = 0; i < surveys; ++i) alarms += !doubtful_lines(lines, drawn(random), {}).empty();
  EXPECT_GT(alarms, 0);  // 5 expected
  EXPECT_LT(alarms, 15);
}

TEST(DoubtfulLines, AShiftedLineIsNamedByItsWorstComponent) {
  std::mt19937 random(2);
  std::vector<LineCorrection> corrections = drawn(random);
  for (auto& v : corrections[2].value) v = {0.01, 0.02, -0.15, 0.0, 0.0, 5e-4};
  const std::vector<Finding> found = doubtful_lines(lines, corrections, {});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NE(found[0].what.find("line 7: "), std::string::npos) << found[0].what;
  EXPECT_NE(found[0].what.find("by 15.0 cm up, 6.7 times"), std::string::npos) << found[0].what;
  EXPECT_FALSE(found[0].refuses);
  for (auto& v : corrections[2].value) v = {0.0, 0.0, 0.0, 0.0, -0.01, 0.0};
  EXPECT_NE(doubtful_lines(lines, corrections, {})[0].what.find("by -2062.6 arcsec in pitch"), std::string::npos);
}

// Surfaces that leave a component's sigma as it is still move it a little: the sigmas are not known to a tenth.
TEST(DoubtfulLines, AComponentThatSurfacesDoNotSeeMayMoveByATenthOfItsSigma) {
  std::mt19937 random(3);
  std::vector<LineCorrection> corrections = drawn(random);
  corrections[0].sigma = corrections[0].apriori;
  for (auto& v : corrections[0].value) v = {0.006, 0.0, 0.0, 0.0, 0.0, 3e-5};
  EXPECT_TRUE(doubtful_lines(lines, corrections, {}).empty());
  for (auto& v : corrections[0].value) v = {0.02, 0.0, 0.0, 0.0, 0.0, 0.0};
  EXPECT_EQ(doubtful_lines(lines, corrections, {}).size(), 1u);
  EXPECT_TRUE(doubtful_lines({}, {}, {}).empty());
  corrections[0].time.clear(), corrections[0].value.clear(), corrections[0].sigma.clear(), corrections[0].apriori.clear();
  EXPECT_TRUE(doubtful_lines(lines, corrections, {}).empty());
}

TEST(DoubtfulLines, ALineMostOfWhoseGroupsAreLeftOutIsNamed) {
  const std::vector<Finding> found = doubtful_lines(lines, {}, groups_of(90, 1, 40));
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NE(found[0].what.find("line 2: 40 of its 90 groups"), std::string::npos) << found[0].what;
  EXPECT_TRUE(doubtful_lines(lines, {}, groups_of(90, 1, 20)).empty());  // things that moved
  EXPECT_TRUE(doubtful_lines(lines, {}, groups_of(12, 1, 8)).empty());   // too few to say
  std::vector<GroupResidual> all = groups_of(90, 1, 40);
  for (GroupResidual& g : all) g.rejected = true;
  EXPECT_TRUE(doubtful_lines(lines, {}, all).empty());  // no line more than the others
}

}  // namespace
}  // namespace swath::calib
