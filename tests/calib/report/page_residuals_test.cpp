// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/report/page_residuals.h"

#include <gtest/gtest.h>

#include "tests/calib/report/made_report.h"
#include "tests/calib/report/part_of_page.h"

namespace swath::calib {
namespace {

TEST(CalibrationPageResiduals, TheWorstOutlierStandsFirst) {
  CalibrationReport r = made_report();
  for (calib::GroupResidual& g : r.adjustment.groups) g.rejected = false;
  EXPECT_TRUE(holds(html_of(r, add_outliers), "No group of returns was taken out."));
  ASSERT_GT(r.adjustment.groups.size(), 5u);
  r.adjustment.groups[2].rejected = r.adjustment.groups[5].rejected = true;
  r.adjustment.groups[2].w = 4.5, r.adjustment.groups[5].w = -8.25;
  const std::string html = html_of(r, add_outliers);
  ASSERT_TRUE(holds(html, "−8.2") && holds(html, "4.5"));
  EXPECT_LT(html.find("−8.2"), html.find("<td class=\"n\">4.5</td>"));
}

TEST(CalibrationPageResiduals, LinesPlanesAndPoints) {
  const CalibrationReport r = made_report();
  const std::string flight = html_of(r, add_flight);
  for (const char* id : {"lines", "overlaps", "planes"}) EXPECT_TRUE(holds(flight, std::string("<table id=\"") + id + "\">")) << id;
  const std::string residuals = html_of(r, add_residuals);
  for (const char* file : {"residuals_line", "residuals_angle", "residuals_range", "residuals_time"})
    EXPECT_TRUE(holds(residuals, std::string("figures/") + file + ".png")) << file;
  EXPECT_TRUE(holds(html_of(r, add_control), "<table id=\"checks\">"));
  EXPECT_TRUE(holds(html_of({}, add_control), "No surveyed point took part"));
}

}  // namespace
}  // namespace swath::calib
