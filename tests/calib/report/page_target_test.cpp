// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/report/page_target.h"

#include <gtest/gtest.h>

#include "tests/calib/report/made_report.h"
#include "tests/calib/report/part_of_page.h"

namespace swath::calib {
namespace {

TEST(CalibrationPageTarget, AReadingIsSetBesideTheAdjustment) {
  CalibrationReport r = made_report();
  const calib::Estimate& roll = r.adjustment.estimates[calib::boresight_roll];
  r.readings = {{calib::boresight_roll, roll.value + 10 * roll.sigma, roll.sigma, 3, "lines 1 and 2"}};
  r.flat_target = {};
  EXPECT_TRUE(holds(html_of(r, add_target), "<td>no</td><td>lines 1 and 2</td>"));
  r.readings[0].value = roll.value + roll.sigma;
  EXPECT_TRUE(holds(html_of(r, add_target), "<td>yes</td><td>lines 1 and 2</td>"));
  r.readings.clear();
  EXPECT_FALSE(holds(html_of(r, add_target), "Flat target"));
}

TEST(CalibrationPageTarget, TheAnalysisHasTablesOfItsOwn) {
  CalibrationReport r = made_report();
  r.readings.clear();
  const std::string html = html_of(r, add_target);
  for (const char* id : {"target-angles", "target-lines", "target-readings"})
    EXPECT_TRUE(holds(html, std::string("<table id=\"") + id + "\">")) << id;
}

}  // namespace
}  // namespace swath::calib
