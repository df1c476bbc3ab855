// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/report/flat_target_report.h"

#include <gtest/gtest.h>

#include "core/config/result_visitors.h"
#include "tests/calib/report/made_report.h"

namespace swath::calib {
namespace {

TEST(FlatTargetReport, TellsAllInOneTree) {
  const core::Value v = value_of(made_target());
  EXPECT_NEAR(v.find("pitch")->find("mean_deg")->as_number(), 0.1, 1e-12);
  EXPECT_TRUE(v.find("pitch")->find("beyond_tolerance")->as_bool());
  EXPECT_EQ(v.find("pitch")->find("readings")->items().size(), 1u);
  EXPECT_FALSE(v.find("roll")->find("determined")->as_bool());
  EXPECT_EQ(v.find("roll")->find("mean_deg"), nullptr);
  ASSERT_EQ(v.find("lines")->items().size(), 2u);
  const core::Value& line = v.find("lines")->items()[0];
  EXPECT_EQ(line.find("role")->as_text(), "edge");
  EXPECT_NEAR(line.find("before")->find("along_m")->as_number(), 1.5, 1e-12);
  EXPECT_EQ(v.find("lines")->items()[1].find("before")->find("why_not")->as_text(), "no returns near the target");
  EXPECT_EQ(v.find("target")->find("corners")->items().size(), 4u);
  const core::Value s = core::reported(made_target());
  EXPECT_EQ(s.find("pitch")->find("readings"), nullptr);
  EXPECT_EQ(s.find("findings")->items()[0].as_text(), "roll is not determined");
  EXPECT_EQ(s.find("lines"), nullptr);
  EXPECT_EQ(s.find("target")->as_text(), "hall");
  EXPECT_FALSE(value_of(FlatTarget{}).find("done")->as_bool());
}

TEST(FlatTargetReport, ReadingsAsATable) {
  const std::string csv = readings_csv(made_target());
  EXPECT_NE(csv.find("pitch,1,2,0.1,deg,4.12"), std::string::npos) << csv;
  EXPECT_NE(csv.find("range_offset,1,,0.12,m,0.03,m"), std::string::npos) << csv;
}

}  // namespace
}  // namespace swath::calib
