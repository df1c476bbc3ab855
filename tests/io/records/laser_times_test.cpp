// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/records/laser_times.h"

#include <gtest/gtest.h>

namespace swath::io {
namespace {

constexpr const char* cut = "lines whose records do not reach their stated begin or end: is a file cut?";

/// Lines of 60 s a minute apart, stated `wider` before and after their records; `last`: where those of line 2 end.
core::Tally counted(double wider, double last) {
  std::vector<LineWindow> windows;
  std::vector<LineSpan> spans;
  for (int line = 1; line <= 3; ++line) {
    const double start = 1e9 + 120.0 * line, end = line == 2 ? start + last : start + 60.0;
    windows.push_back({line, start - wider, start + 60.0 + wider});
    spans.push_back({line, start, end});
  }
  core::Tally tally;
  count_cut_lines(windows, spans, tally);
  return tally;
}

TEST(LaserTimes, ALineWhoseLastRecordsAreMissingIsNoticed) {
  const core::Tally tally = counted(0.0001, 50.0);
  EXPECT_EQ(tally.of(cut), 1u);
  EXPECT_EQ(tally.value().find(cut)->find("examples")->items()[0].as_text(), "line 2: 10 s of 60 s are missing at its end");
  EXPECT_EQ(counted(0.5, 50.0).of(cut), 1u);
}

TEST(LaserTimes, WholeLinesAndWiderWindowsAreNot) {
  EXPECT_TRUE(counted(0.0001, 60.0).empty());
  EXPECT_TRUE(counted(10.0, 60.0).empty());
  EXPECT_TRUE(counted(10.0, 55.0).empty());
}

TEST(LaserTimes, ALineWithoutARecordIsCounted) {
  core::Tally tally;
  count_cut_lines({{4, 1e9, 1e9 + 60}}, {}, tally);
  EXPECT_EQ(tally.of("lines without a record"), 1u);
}

}  // namespace
}  // namespace swath::io
