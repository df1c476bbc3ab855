// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/survey/line_checks.h"

#include <gtest/gtest.h>

namespace swath::io {
namespace {

Survey with_lines(core::TimeScale scale, const std::vector<std::pair<double, double>>& windows) {
  Survey s;
  s.line_time.scale = scale;
  for (const auto& [start, end] : windows)
    s.lines.push_back({static_cast<int>(s.lines.size()) + 1, "", core::Seconds(start), core::Seconds(end)});
  return s;
}

TEST(LineChecks, ALineAcrossTheEndOfTheWeekHasALength) {
  const Survey s = with_lines(core::TimeScale::gps_week, {{604700, 604770}, {604780, 30}, {90, 140}});
  EXPECT_TRUE(line_faults(s).empty());
  EXPECT_EQ(seconds_of(s, s.lines[1]), 50.0);
}

TEST(LineChecks, AnOverlapBeyondTheEndOfTheWeekIsNamed) {
  const std::vector<LineFault> faults = line_faults(with_lines(core::TimeScale::gps_week, {{604600, 604700}, {604780, 100}, {60, 300}}));
  ASSERT_EQ(faults.size(), 1u);
  EXPECT_EQ(faults[0].line, 2u);
  EXPECT_EQ(faults[0].what, "the line starts before line[2] ends");
}

TEST(LineChecks, OverlapsAndIdsAreNamed) {
  Survey s = with_lines(core::TimeScale::gps, {{0, 10}, {5, 20}});
  s.lines[1].id = 1;
  const std::vector<LineFault> faults = line_faults(s);
  ASSERT_EQ(faults.size(), 2u);
  EXPECT_EQ(faults[0].what, "id 1 is taken by line[1] already");
  EXPECT_EQ(faults[1].what, "the line starts before line[1] ends");
}

}  // namespace
}  // namespace swath::io
