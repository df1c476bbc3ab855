// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/survey/describe_products.h"

#include <gtest/gtest.h>

#include "io/survey/info.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

TEST(DescribeProducts, APlannedFlightIsNotASurveyWithFaults) {
  const test::TemporaryFolder folder;
  test::write_bytes(
      folder / "plan.json",
      R"({"name": "valley", "crs": "EPSG:32632", "area_m2": 250000, "direction_deg": 90, "line_length_m": 4200, "time_s": 300,)"
      R"( "lines": [{"name": "L1"}, {"name": "L2"}], "warnings": ["the eye-safe height is not kept"]})");
  const std::string text = info_text(describe_file(folder / "plan.json"));
  EXPECT_NE(text.find("planned flight"), std::string::npos) << text;
  EXPECT_NE(text.find("valley"), std::string::npos) << text;
  EXPECT_NE(text.find("4200"), std::string::npos) << text;
  EXPECT_NE(text.find("the eye-safe height is not kept"), std::string::npos) << text;
}

TEST(DescribeProducts, AQualityReportIsNotDelimitedText) {
  const test::TemporaryFolder folder;
  const auto report = [](const std::string& passed) {
    return "<mdq:report><mdq:pass><gco:Boolean>" + passed + "</gco:Boolean></mdq:pass></mdq:report>";
  };
  test::write_bytes(folder / "quality.xml", "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<mdq:DQ_DataQuality>" + report("true") +
                                                report("true") + report("false") + "</mdq:DQ_DataQuality>");
  const core::Value facts = describe_file(folder / "quality.xml");
  EXPECT_EQ(facts.find("format")->as_text(), "data quality by ISO 19157-2");
  EXPECT_EQ(facts.find("reports")->as_int(), 3);
  EXPECT_EQ(facts.find("requirements_met")->as_int(), 2);
  EXPECT_EQ(facts.find("requirements_missed")->as_int(), 1);
}

}  // namespace
}  // namespace swath::io
