// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/report/figures.h"

#include <gtest/gtest.h>

#include <set>

#include "tests/calib/report/made_report.h"

namespace swath::calib {
namespace {

size_t points_of(const report::Panel& p) {
  size_t n = 0;
  for (const report::Series& s : p.series) n += s.x.size();
  return n;
}

TEST(CalibrationFigures, EveryGroupIsADotInEveryResidualChart) {
  const CalibrationReport r = made_report();
  for (const BinBy by : {BinBy::line, BinBy::angle, BinBy::range, BinBy::time}) {
    const report::Chart c = residual_chart(r, by);
    ASSERT_EQ(c.panels.size(), 2u);
    for (const report::Panel& p : c.panels) EXPECT_EQ(points_of(p), r.adjustment.groups.size());
    EXPECT_EQ(c.panels[0].series.back().name, "taken out");
    EXPECT_GT(report::draw(c).height, 400);
  }
  const report::Chart lines = residual_chart(r, BinBy::line);
  EXPECT_EQ(lines.panels[0].x_names, (std::vector<std::string>{"1", "2", "3", "4", "5", "6"}));
  for (size_t k = 0; k < 6; ++k)
    for (const double x : lines.panels[1].series[k].x) EXPECT_NEAR(x, static_cast<double>(k), 0.5);
  // In cm.
  EXPECT_DOUBLE_EQ(lines.panels[1].series[r.adjustment.groups[0].line].y[0], 100.0 * r.adjustment.groups[0].after);
}

TEST(CalibrationFigures, ALineHasOneColourEverywhereAndNeverThatOfWhatIsTakenOut) {
  const CalibrationReport r = made_report();
  const report::Chart residuals = residual_chart(r, BinBy::time), section = section_chart(r, r.sections[0]);
  std::set<int> colours;
  for (size_t k = 0; k < r.ties.lines.size(); ++k) {
    EXPECT_EQ(residuals.panels[0].series[k].colour, line_colour(k));
    EXPECT_EQ(section.panels[1].series[k].colour, line_colour(k));
    EXPECT_EQ(correction_chart(r)->panels[3].series[2 * k + 1].colour, line_colour(k));
    EXPECT_NE(line_colour(k), residuals.panels[0].series.back().colour);
  }
  for (size_t k = 0; k < 18; ++k) colours.insert(line_colour(k));
  EXPECT_EQ(colours.size(), 18u);
}

TEST(CalibrationFigures, SectionsAreThinnedEvenly) {
  CalibrationReport r = made_report();
  CrossSection s = r.sections[0];
  EXPECT_EQ(points_of(section_chart(r, s).panels[0]), 6u * 260u);
  const report::Chart few = section_chart(r, s, 100);
  for (const report::Series& line : few.panels[0].series) {
    EXPECT_LE(line.x.size(), 100u);
    EXPECT_GE(line.x.size(), 50u);
  }
}

TEST(CalibrationFigures, NothingToDrawIsNoFigure) {
  CalibrationReport r;
  EXPECT_FALSE(correction_chart(r).has_value());
  EXPECT_FALSE(correlation_chart(r).has_value());
  r = made_report();
  ASSERT_TRUE(correlation_chart(r).has_value());
  EXPECT_EQ(correlation_chart(r)->names.back(), "scan scale");
  EXPECT_DOUBLE_EQ(correlation_chart(r)->values[3 * 6 + 4], -0.91);
}

}  // namespace
}  // namespace swath::calib
