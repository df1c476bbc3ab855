// SPDX-License-Identifier: GPL-3.0-or-later
// What the numbers of a page say is checked against the files beside it in tests/cli/calibration_report_test.py.
#include "calib/report/page.h"

#include <gtest/gtest.h>

#include <map>

#include "tests/calib/report/made_report.h"
#include "tests/calib/report/part_of_page.h"

namespace swath::calib {
namespace {

struct Made {
  std::string html;
  std::map<std::string, core::Picture> figures;
};

Made page_of(const CalibrationReport& r) {
  Made out;
  out.html = calibration_page(r, [&](const std::string& file, const core::Picture& picture) {
    EXPECT_TRUE(out.figures.emplace(file, picture).second) << file << " is made twice";
    return std::string("png");
  });
  return out;
}

TEST(CalibrationPage, HoldsEveryPartAndKeepsEveryFigure) {
  const Made m = page_of(made_report());
  for (const char* id : {"findings",
                         "values-angles",
                         "values-lengths",
                         "values-scales",
                         "adjustment",
                         "components",
                         "readings",
                         "target-angles",
                         "target-lines",
                         "target-readings",
                         "lines",
                         "overlaps",
                         "planes",
                         "residuals",
                         "residuals-by-line",
                         "residuals-by-angle",
                         "residuals-by-range",
                         "residuals-by-time",
                         "outliers",
                         "control",
                         "checks",
                         "corrections",
                         "sections",
                         "differences"})
    EXPECT_TRUE(holds(m.html, std::string("<table id=\"") + id + "\">")) << id;
  EXPECT_FALSE(holds(m.html, "values-time")) << "nothing of it was estimated";
  EXPECT_EQ(m.figures.size(), 4u + 1u + 1u + 1u + 6u);
  for (const auto& [file, picture] : m.figures) {
    EXPECT_TRUE(holds(m.html, "<code>" + file + "</code>")) << file;
    EXPECT_GT(picture.width, 300) << file;
    EXPECT_GT(picture.height, 150) << file;
  }
}

TEST(CalibrationPage, ARefusedParameterShowsNoValue) {
  const Made good = page_of(made_report()), refused = page_of(made_report(true));
  const char* row = "<td>range\u00A0scale</td><td class=\"n\">0.0</td><td class=\"n\">";
  EXPECT_TRUE(holds(good.html, std::string(row) + "31.0"));
  EXPECT_TRUE(holds(refused.html, std::string(row) + "–"));
  EXPECT_TRUE(holds(refused.html, "not determined"));
  EXPECT_TRUE(holds(refused.html, "fly the same lines at twice the height"));
}

TEST(CalibrationPage, AnEmptyReportStillSaysSo) {
  const Made m = page_of(CalibrationReport{});
  EXPECT_TRUE(holds(m.html, "Not calibrated: no parameter was estimated."));
  EXPECT_TRUE(holds(m.html, "No surveyed point took part"));
  EXPECT_TRUE(holds(m.html, "No group of returns was taken out."));
}

TEST(CalibrationPage, OfManyPairsOnlyTheWorstMapsAreSetIn) {
  CalibrationReport r = made_report();
  const LineDifference d = r.differences[0];
  for (int k = 10; k < 15; ++k) {
    r.differences.push_back(d);
    r.differences.back().line_b = k;
  }
  // The last pair fits best.
  for (float& h : r.differences.back().after.height) h *= 0.1f;
  const Made m = page_of(r);
  EXPECT_EQ(m.figures.size(), 4u + 1u + 1u + 1u + 16u);
  EXPECT_TRUE(holds(m.html, "figures/difference_1_10_after.png"));
  EXPECT_FALSE(holds(m.html, "figures/difference_1_14_after.png"));
  EXPECT_TRUE(holds(m.html, "those of the others are in the folder figures"));
}

}  // namespace
}  // namespace swath::calib
