// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/flight_plan/plan_page.h"

#include <gtest/gtest.h>

#include "tests/pipeline/flight_plan/flight_plan_support.h"

namespace swath::pipeline {
namespace {

std::string page_of(const std::string& flight) {
  const test::TemporaryFolder folder;
  const PlanInput in = read_plan_input(request_of(folder, plan_toml("crs = \"EPSG:32632\"\nground = \"500 m\"", flight)));
  return plan_page(planning::make_flight_plan(in.options, in.area, in.ground), in);
}

TEST(PlanPage, HoldsMapsLinesAndErrors) {
  const std::string html = page_of("height = \"600 m\"");
  size_t pictures = 0;
  for (size_t at = html.find("data:image/png"); at != std::string::npos; at = html.find("data:image/png", at + 1)) ++pictures;
  EXPECT_EQ(pictures, 3u);
  for (const char* part : {"nothing in it stands out", "line 1", "scan angle", "Eye safety", "Photogrammetry", "EUR", "km2"})
    EXPECT_NE(html.find(part), std::string::npos) << part;
}

TEST(PlanPage, WarningsComeFirst) {
  const std::string html = page_of("height = \"600 m\"\n[[base]]\nname = \"far\"\neast = \"500000 m\"\nnorth = \"5300000 m\"");
  EXPECT_NE(html.find("needs a look"), std::string::npos);
  EXPECT_LT(html.find("50 km"), html.find("The flight in figures"));
}

}  // namespace
}  // namespace swath::pipeline
