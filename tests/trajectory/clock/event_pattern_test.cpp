// SPDX-License-Identifier: GPL-3.0-or-later
#include "trajectory/clock/event_pattern.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace swath::trajectory {
namespace {

/// Three lines of 20 exposures, two seconds apart but for 5 %, a minute between lines.
core::EventTags exposures() {
  core::EventTags out;
  out.technique = "pc";
  std::mt19937 random(1);
  double t = 100.0;
  for (int line = 0; line < 3; ++line, t += 60.0)
    for (int k = 0; k < 20; ++k) {
      out.time.push_back(t);
      out.id.push_back("P" + std::to_string(out.id.size() + 1));
      t += 2.0 + 0.1 * (static_cast<double>(random()) / static_cast<double>(random.max()) - 0.5);
    }
  return out;
}
void drop(core::EventTags& e, size_t i) {
  e.time.erase(e.time.begin() + static_cast<long>(i));
  e.id.erase(e.id.begin() + static_cast<long>(i));
}

TEST(EventPattern, WholeLinesHaveNoBreaks) {
  const EventPattern p = pattern_of(exposures());
  EXPECT_NEAR(p.interval, 2.0, 0.05);
  EXPECT_EQ(p.intervals, 57u);
  EXPECT_EQ(p.regular, 57u);
  EXPECT_TRUE(p.breaks.empty());
}

TEST(EventPattern, MissingAndDoubleEventsHaveFigures) {
  core::EventTags e = exposures();
  drop(e, 45);
  drop(e, 30), drop(e, 30);
  e.time.insert(e.time.begin() + 11, e.time[10] + 0.012);
  e.id.insert(e.id.begin() + 11, "P11b");
  const EventPattern p = pattern_of(e);
  EXPECT_EQ(p.missing, 3u);
  EXPECT_EQ(p.doubles, 1u);
  ASSERT_EQ(p.breaks.size(), 3u);
  EXPECT_EQ(p.breaks[0].missing, 0u);
  EXPECT_EQ(e.id[p.breaks[0].after], "P11b");
  EXPECT_EQ(p.breaks[1].missing, 2u);
  EXPECT_NEAR(p.breaks[1].interval, 6.0, 0.2);
  core::Tally tally;
  count_breaks(e, p, tally);
  EXPECT_EQ(tally.of("events missing by the pattern of intervals"), 3u);
  EXPECT_EQ(tally.of("events recorded twice by the pattern of intervals"), 1u);
}

/// Both edges of each pulse recorded: every second interval is the pulse's width.
TEST(EventPattern, WhenEveryEventIsThereTwiceThatIsSaid) {
  const core::EventTags once = exposures();
  core::EventTags e;
  e.technique = once.technique;
  for (size_t i = 0; i < once.time.size(); ++i)
    for (const double width : {0.0, 0.012}) e.time.push_back(once.time[i] + width), e.id.push_back(once.id[i]);
  const EventPattern p = pattern_of(e);
  EXPECT_NEAR(p.interval, 2.0, 0.05);
  EXPECT_EQ(p.doubles, 60u);
  EXPECT_EQ(p.missing, 0u);
  EXPECT_EQ(p.regular, 57u);
}

TEST(EventPattern, EventsWithoutAPatternAreNotJudged) {
  core::EventTags e;
  double t = 0.0;
  for (int k = 0; k < 40; ++k) {
    e.time.push_back(t += std::exp(0.15 * k - 3.0));
    e.id.push_back(std::to_string(k));
  }
  EXPECT_EQ(pattern_of(e).interval, 0.0);
  EXPECT_TRUE(pattern_of(e).breaks.empty());
  core::EventTags few = exposures();
  few.time.resize(4), few.id.resize(4);
  EXPECT_EQ(pattern_of(few).interval, 0.0);
}

TEST(EventPattern, TheOrderOfTheFileDoesNotMatter) {
  core::EventTags e = exposures();
  drop(e, 30);
  std::swap(e.time[3], e.time[50]);
  std::swap(e.id[3], e.id[50]);
  EXPECT_EQ(pattern_of(e).missing, 1u);
}

}  // namespace
}  // namespace swath::trajectory
