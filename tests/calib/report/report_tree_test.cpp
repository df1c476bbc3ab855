// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/report/report_tree.h"

#include <gtest/gtest.h>

#include "tests/calib/report/made_report.h"

namespace swath::calib {
namespace {

TEST(ReportTree, HoldsNoValueOfWhatIsRefused) {
  const core::Value tree = calibration_report_tree(made_report(true));
  for (const core::Value& e : tree.find("estimates")->items()) {
    const bool refused = e.find("parameter")->as_text() == "range_scale";
    const bool estimated = e.find("estimated")->as_bool();
    EXPECT_EQ(e.find("delivered")->as_bool(), estimated && !refused) << e.find("name")->as_text();
    EXPECT_EQ(e.find("value") != nullptr, estimated && !refused) << e.find("name")->as_text();
  }
  EXPECT_EQ(tree.find("correlation")->find("matrix")->items().size(), core::calibration_keys.size());
  EXPECT_EQ(tree.find("flight")->find("lines")->items().size(), 6u);
  EXPECT_EQ(tree.find("differences")->items()[2].find("before")->find("file")->as_text(), "differences/2_5_before.tif");
}

TEST(ReportTree, UnknownFiguresAreNullAndOfStripsNoParameterIsThere) {
  CalibrationReport r = made_report();
  r.adjustment.estimates[boresight_roll].jackknife_lines = not_known;
  const core::Value calibration = calibration_report_tree(r);
  const core::Value& roll = calibration.find("estimates")->items()[boresight_roll];
  ASSERT_NE(roll.find("jackknife_lines"), nullptr);
  EXPECT_TRUE(roll.find("jackknife_lines")->is_null());
  EXPECT_EQ(calibration.find("residuals")->find("by_line")->items()[1].find("line")->as_int(), 2);
  EXPECT_EQ(calibration.find("residuals")->find("by_line")->items()[1].find("from"), nullptr);
  EXPECT_EQ(calibration.find("checks")->items()[0].find("plane"), nullptr);
  r.strips = PlaneDifferences{{{1, 2, 7, 0.1, 0.2, 0.0, 0.01}}, {0, 0, 7, 0.1, 0.2, 0.0, 0.01}};
  const core::Value strips = calibration_report_tree(r);
  for (const char* of_values : {"calibration", "sigma", "correlation", "calibrated", "estimates"})
    EXPECT_EQ(strips.find(of_values), nullptr);
  EXPECT_EQ(strips.find("plane_differences")->find("pairs")->items()[0].find("lines")->items()[1].as_int(), 2);
  EXPECT_EQ(strips.find("plane_differences")->find("all")->find("lines"), nullptr);
}

}  // namespace
}  // namespace swath::calib
