// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/report/page_values.h"

#include <gtest/gtest.h>

#include "tests/calib/report/made_report.h"
#include "tests/calib/report/part_of_page.h"

namespace swath::calib {
namespace {

TEST(CalibrationPageValues, ATableForEachKindOfValueThatWasEstimated) {
  CalibrationReport r = made_report();
  for (calib::Estimate& e : r.adjustment.estimates) e.estimated = e.parameter == calib::latency;
  calib::Estimate& late = r.adjustment.estimates[calib::latency];
  late.start = 0.0, late.value = 0.0025, late.sigma = 0.0001, late.parameter = calib::latency;
  const std::string html = html_of(r, add_values);
  EXPECT_TRUE(holds(html, "<table id=\"values-time\">"));
  EXPECT_FALSE(holds(html, "values-angles"));
  EXPECT_TRUE(holds(
      html, "<td>latency</td><td class=\"n\">0.000</td><td class=\"n\">2.500</td><td class=\"n\">2.500</td><td class=\"n\">0.100</td>"))
      << "nominal, value, change and sigma in ms";
  EXPECT_TRUE(holds(html, "Held at the start value and not estimated: boresight roll, "));
}

TEST(CalibrationPageValues, OfStripsTheDifferencesOnPlanes) {
  CalibrationReport r = made_report();
  r.strips.emplace();
  r.strips->pairs = {{3, 7, 11, 0.021, 0.034, -0.001, 0.004}};
  r.strips->all = r.strips->pairs[0];
  const std::string html = html_of(r, add_plane_differences);
  EXPECT_TRUE(
      holds(html,
            "<td class=\"n\">3</td><td class=\"n\">7</td><td class=\"n\">11</td><td class=\"n\">2.10</td><td class=\"n\">3.40</td><td "
            "class=\"n\">−0.10</td><td class=\"n\">0.40</td>"));
  EXPECT_FALSE(holds(html_of(r, add_summary), "condition number")) << "nothing but corrections was estimated";
  EXPECT_TRUE(holds(html_of(made_report(), add_summary), "condition number"));
}

TEST(CalibrationPageValues, OneValueHasNoCorrelations) {
  CalibrationReport r = made_report();
  EXPECT_TRUE(holds(html_of(r, add_correlations), "figures/correlation.png"));
  for (calib::Estimate& e : r.adjustment.estimates) e.estimated = e.parameter == calib::boresight_roll;
  EXPECT_FALSE(holds(html_of(r, add_correlations), "Correlations"));
}

}  // namespace
}  // namespace swath::calib
