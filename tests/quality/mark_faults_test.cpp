// SPDX-License-Identifier: GPL-3.0-or-later
#include "quality/mark_faults.h"

#include <gtest/gtest.h>

#include <functional>
#include <random>
#include <utility>

namespace swath::quality {
namespace {

constexpr double mark_sigma = 0.02, line_sigma = 0.03, noise = 0.01;

struct Case {
  std::vector<CheckMark> marks;
  std::vector<MarkReading> readings;
};

/// Twelve marks, four lines that show half of them each; errors drawn from the stated sigmas. `change`: what is wrong.
Case drawn(unsigned seed, const std::function<double(int mark, int line)>& change) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Case c;
  std::vector<double> of_mark, of_line;
  for (int m = 0; m < 12; ++m) {
    c.marks.push_back({"M" + std::to_string(m), "", "check.csv:" + std::to_string(m + 2), {}, mark_sigma});
    of_mark.push_back(mark_sigma * normal(random));
  }
  for (int l = 0; l < 4; ++l) of_line.push_back(line_sigma * normal(random));
  for (int m = 0; m < 12; ++m)
    for (int l = 0; l < 4; ++l) {
      if ((m + l) % 2) continue;
      const double d = of_line[static_cast<size_t>(l)] - of_mark[static_cast<size_t>(m)] + noise * normal(random) + change(m, l + 1);
      c.readings.push_back({m, l + 1, 8, static_cast<float>(d), static_cast<float>(line_sigma), 0.0f, 0.02f});
    }
  return c;
}

using Codes = std::vector<std::string>;

std::vector<std::string> codes(const Case& c) {
  std::vector<std::string> out;
  for (const NamedFault& f : find_faults(c.marks, c.readings).named) out.push_back(f.code);
  return out;
}

TEST(MarkFaults, NothingIsNamedWhereNothingIsWrong) {
  int named = 0;
  for (unsigned seed = 1; seed <= 200; ++seed) named += static_cast<int>(codes(drawn(seed, [](int, int) { return 0.0; })).size());
  EXPECT_LE(named, 1);  // beyond four sigmas
}

TEST(MarkFaults, ABadMarkIsNamed) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const Case c = drawn(seed, [](int m, int) { return m == 5 ? -0.4 : 0.0; });
    const MarkFaults f = find_faults(c.marks, c.readings);
    ASSERT_EQ(f.named.size(), 1u) << seed;
    EXPECT_EQ(f.named[0].code, "check.mark");
    EXPECT_NE(f.named[0].sentence.find("M5 (check.csv:7)"), std::string::npos) << f.named[0].sentence;
    EXPECT_NE(f.named[0].sentence.find("below"), std::string::npos);
  }
}

/// Twelve marks on a slope from 80 to 190 m, their heights times a factor.
Case scaled(double factor, double lowest = 80.0) {
  Case c = drawn(3, [](int, int) { return 0.0; });
  for (size_t m = 0; m < c.marks.size(); ++m) c.marks[m].at.z() = factor * (lowest + 10.0 * static_cast<double>(m));
  for (MarkReading& r : c.readings) r.difference += static_cast<float>((1 / factor - 1) * c.marks[static_cast<size_t>(r.mark)].at.z());
  return c;
}

TEST(MarkFaults, HeightsInFeetAreNamedAsThat) {
  for (const auto& [factor, words] : {std::pair(1 / 0.3048, "times those of the ground (12 of 12 within 1 %): they are in feet"),
                                      std::pair(0.3048, "times those of the ground (12 of 12 within 1 %): they are in metres")}) {
    const Case c = scaled(factor);
    const MarkFaults f = find_faults(c.marks, c.readings);
    ASSERT_EQ(f.named.size(), 1u);
    EXPECT_EQ(f.named[0].code, "check.heights");
    EXPECT_NE(f.named[0].sentence.find(words), std::string::npos) << f.named[0].sentence;
  }
  for (const double factor : {1.0, 1.5, 3.0})
    for (const NamedFault& f : find_faults(scaled(factor).marks, scaled(factor).readings).named)
      EXPECT_EQ(f.sentence.find("feet"), std::string::npos) << factor << f.sentence;
  // Ground at the level of the sea says nothing, the rest does.
  EXPECT_EQ(codes(scaled(1 / 0.3048, -50.0)), Codes{"check.heights"});
}

/// Whichever way one line of two differs, the mark is not to blame, for the other line agrees with it.
TEST(MarkFaults, OneLineOfTwoIsNoBadMark) {
  for (const double wrong : {0.4, -0.4})
    for (unsigned seed = 1; seed <= 20; ++seed)
      EXPECT_EQ(codes(drawn(seed, [&](int m, int line) { return m == 5 && line == 2 ? wrong : 0.0; })), Codes{}) << wrong << " " << seed;
}

/// Plants that passed as ground scatter about their plane: a mark among them is not named for what they do.
TEST(MarkFaults, PlantsAreNoBadMark) {
  Case c = drawn(4, [](int m, int) { return m == 5 ? 0.2 : 0.0; });
  EXPECT_EQ(codes(c), Codes{"check.mark"});
  for (MarkReading& r : c.readings)
    if (r.mark == 5) r.scatter = 0.1f;
  EXPECT_TRUE(codes(c).empty());
}

TEST(MarkFaults, AShiftedLineIsNamed) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const Case c = drawn(seed, [](int, int l) { return l == 3 ? 0.4 : 0.0; });
    const MarkFaults f = find_faults(c.marks, c.readings);
    ASSERT_EQ(f.named.size(), 1u) << seed;
    EXPECT_EQ(f.named[0].code, "check.line");
    EXPECT_NE(f.named[0].sentence.find("line 3 lies"), std::string::npos) << f.named[0].sentence;
    EXPECT_NEAR(f.lines[2].difference, 0.4, 0.15);
  }
}

TEST(MarkFaults, AWrongGeoidIsNamedOnce) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const Case c = drawn(seed, [](int, int) { return -46.8; });
    const MarkFaults f = find_faults(c.marks, c.readings);
    ASSERT_EQ(f.named.size(), 1u) << seed;
    EXPECT_EQ(f.named[0].code, "check.heights");
    EXPECT_NEAR(f.common, -46.8, 0.1);
    EXPECT_NE(f.named[0].sentence.find("geoid"), std::string::npos);
  }
}

TEST(MarkFaults, ADifferenceLikeTheGeoidsSaysWhoseHeightsAreWhich) {
  const auto said = [](double common, double undulation) {
    const Case c = drawn(3, [common](int, int) { return common; });
    return find_faults(c.marks, c.readings, [undulation] { return undulation; }).named.at(0).sentence;
  };
  const std::string ellipsoidal = "either the check points' heights are ellipsoidal";
  const std::string levelled = "either the check points' heights are above the geoid";
  EXPECT_NE(said(-46.8, 46.6).find(ellipsoidal), std::string::npos) << said(-46.8, 46.6);
  EXPECT_NE(said(31.0, -31.6).find(ellipsoidal), std::string::npos);
  EXPECT_NE(said(46.8, 46.6).find(levelled), std::string::npos);
  EXPECT_NE(said(-31.0, -31.6).find(levelled), std::string::npos);
  for (const auto& [common, undulation] : {std::pair(-46.8, 40.0), {-46.8, std::nan("")}, {0.9, 0.8}, {0.5, 46.6}})
    EXPECT_NE(said(common, undulation).find("compare geoid, height system and antenna heights"), std::string::npos) << common;
}

TEST(MarkFaults, AllThreeAtOnce) {
  for (unsigned seed = 1; seed <= 20; ++seed)
    EXPECT_EQ(codes(drawn(seed, [](int m, int l) { return 2.0 + (m == 5 ? 0.4 : 0.0) + (l == 2 ? -0.5 : 0.0); })),
              (Codes{"check.heights", "check.line", "check.mark"}))
        << seed;
}

TEST(MarkFaults, OfTwoMarksNoneIsNamed) {
  Case c = drawn(3, [](int m, int) { return m == 5 ? 0.4 : 0.0; });
  std::erase_if(c.readings, [](const MarkReading& r) { return r.mark != 5 && r.mark != 6; });
  EXPECT_FALSE(c.readings.empty());
  EXPECT_TRUE(codes(c).empty());
}

TEST(MarkFaults, OfOneLineAloneTheHeightsAreNamed) {
  Case c = drawn(3, [](int, int) { return 0.5; });
  std::erase_if(c.readings, [](const MarkReading& r) { return r.line != 1; });
  EXPECT_EQ(codes(c), Codes{"check.heights"});
  EXPECT_TRUE(find_faults(c.marks, {}).named.empty());
}

}  // namespace
}  // namespace swath::quality
