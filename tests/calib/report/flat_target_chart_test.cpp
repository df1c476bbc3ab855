// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/report/flat_target_chart.h"

#include <gtest/gtest.h>

#include "tests/calib/report/made_report.h"

namespace swath::calib {
namespace {

TEST(FlatTargetChart, IsDrawn) {
  const report::Chart c = chart_of(made_target());
  ASSERT_EQ(c.panels.size(), 4u);
  EXPECT_NE(c.panels[1].title.find("enlarged 2 times"), std::string::npos) << c.panels[1].title;
  EXPECT_NE(c.panels[2].title.find("enlarged 200 times"), std::string::npos) << c.panels[2].title;
  const core::Picture p = report::draw(c);
  EXPECT_GT(p.height, 1000);
  EXPECT_TRUE(chart_of({}).panels.empty());
}

}  // namespace
}  // namespace swath::calib
