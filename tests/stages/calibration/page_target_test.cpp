// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/calibration/page_target.h"

#include <gtest/gtest.h>

#include "tests/stages/calibration/made_report.h"

namespace swath::stages {
namespace {

bool holds(const std::string& text, const std::string& what) { return text.find(what) != std::string::npos; }

std::string html_of(const CalibrationReport& report, void (*add)(const PageParts&)) {
  report::Page page("part");
  const KeepFigure keep = [](const std::string&, const core::Picture&) { return std::string("png"); };
  add({report, keep, page});
  return page.html();
}

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

TEST(CalibrationPageTarget, DetailsAreTablesOfTheirColumns) {
  CalibrationReport r = made_report();
  r.readings.clear();
  core::Value one, two, tree;
  one["line"] = 1;
  one["shift"] = -0.25;
  two["line"] = 2;
  two["note"] = "profile";
  tree["done"] = true;
  tree["lines"].push(one);
  tree["lines"].push(two);
  r.flat_target = tree;
  const std::string html = html_of(r, add_target);
  EXPECT_TRUE(holds(html, "<td>done</td><td>yes</td>"));
  EXPECT_TRUE(holds(html, "<td class=\"n\">1</td><td class=\"n\">−0.25</td><td></td>"));
  EXPECT_TRUE(holds(html, "<td class=\"n\">2</td><td class=\"n\"></td><td>profile</td>"));
  EXPECT_TRUE(holds(html, "id=\"detail-2\""));
}

}  // namespace
}  // namespace swath::stages
