// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/flight_plan/plan_input.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/pipeline/flight_plan/flight_plan_support.h"

namespace swath::pipeline {
namespace {

std::string refusal(const PlanRequest& request) {
  try {
    read_plan_input(request);
  } catch (const core::Error& e) {
    return e.text();
  }
  return "";
}

TEST(PlanInput, TheModelSaysWhichCrs) {
  const test::TemporaryFolder folder;
  write_hills(folder / "hills.tif");
  const PlanInput in = read_plan_input(request_of(folder, plan_toml("dem = \"hills.tif\"")));
  EXPECT_EQ(in.options.crs, "EPSG:32632");
  EXPECT_NEAR(in.mean_ground, 500, 30);
  EXPECT_GT(in.ground.highest(), 530);
  ASSERT_EQ(in.area.size(), 1u);
  EXPECT_EQ(in.area[0].size(), 4u);
}

TEST(PlanInput, AnAreaInDegrees) {
  const test::TemporaryFolder folder;
  write_hills(folder / "hills.tif");
  test::write_bytes(folder / "area.geojson",
                    R"({"type":"Polygon","coordinates":[[[10.350,47.85],[10.365,47.85],[10.365,47.86],[10.350,47.86],[10.350,47.85]]]})");
  std::string toml = plan_toml("dem = \"hills.tif\"\narea = \"area.geojson\"");
  const size_t from = toml.find("corner"), to = toml.find("[sensor]");
  toml.erase(from, to - from);
  const PlanInput in = read_plan_input(request_of(folder, toml));
  ASSERT_EQ(in.area.size(), 1u);
  EXPECT_NEAR((in.area[0][1] - in.area[0][0]).norm(), 0.015 * 111320 * std::cos(47.85 * M_PI / 180), 3);
}

TEST(PlanInput, TheUtmZoneOfAnAreaInDegreesIsNamed) {
  const test::TemporaryFolder folder;
  const auto refusal_of = [&](const std::string& area, const std::string& more) {
    test::write_bytes(folder / "area.geojson", R"({"type":"Polygon",)" + area + "}");
    std::string toml = plan_toml("ground = \"500 m\"\narea = \"area.geojson\"\n" + more);
    const size_t from = toml.find("corner"), to = toml.find("[sensor]");
    toml.erase(from, to - from);
    return refusal(request_of(folder, toml));
  };
  const std::string alps = R"("coordinates":[[[10.35,47.85],[10.36,47.85],[10.36,47.86],[10.35,47.85]]])";
  const std::string south = R"("coordinates":[[[-70.5,-33.1],[-70.4,-33.1],[-70.4,-33.0],[-70.5,-33.1]]])";
  EXPECT_NE(refusal_of(alps, "").find("as crs: EPSG:32632. "), std::string::npos) << refusal_of(alps, "");
  EXPECT_NE(refusal_of(south, "").find("as crs: EPSG:32719. "), std::string::npos) << refusal_of(south, "");
  // Corners in the file's own CRS, whatever the plan's is.
  EXPECT_NE(refusal_of(alps, "crs = \"EPSG:2269\"").find("as crs: EPSG:32632. "), std::string::npos);
}

TEST(PlanInput, WhatDoesNotFitIsRefused) {
  const test::TemporaryFolder folder;
  write_hills(folder / "hills.tif");
  write_hills(folder / "other.tif", "EPSG:25832");
  EXPECT_NE(refusal(request_of(folder, plan_toml("crs = \"EPSG:32632\""))).find("no ground"), std::string::npos);
  EXPECT_NE(refusal(request_of(folder, plan_toml("ground = \"500 m\""))).find("CRS is not known"), std::string::npos);
  EXPECT_NE(refusal(request_of(folder, plan_toml("ground = \"500 m\"\ndem = \"hills.tif\""))).find("both"), std::string::npos);
  EXPECT_NE(refusal(request_of(folder, plan_toml("crs = \"EPSG:4326\"\nground = \"500 m\""))).find("metres"), std::string::npos);
  // Oregon north in feet: the corners lie in UTM zone 10 or so, by whatever numbers they have.
  EXPECT_NE(refusal(request_of(folder, plan_toml("crs = \"EPSG:2269\"\nground = \"500 m\""))).find("as crs: EPSG:326"), std::string::npos);
  EXPECT_NE(refusal(request_of(folder, plan_toml("crs = \"EPSG:2048\"\nground = \"500 m\""))).find("EPSG:32734"), std::string::npos);
  EXPECT_NE(refusal(request_of(folder, plan_toml("crs = \"EPSG:32632\"\ndem = \"other.tif\""))).find("warp"), std::string::npos);
  EXPECT_NE(refusal(request_of(folder, plan_toml("crs = \"EPSG:32632\"\ndem = \"none.tif\""))).find("none.tif"), std::string::npos);
  EXPECT_NE(refusal(request_of(folder, plan_toml("simulate = 3\nground = \"500 m\""))).find("no table"), std::string::npos);
  EXPECT_NE(refusal(request_of(folder, plan_toml("grond = \"500 m\""))).find("ground"), std::string::npos);
  PlanRequest r = request_of(folder, plan_toml("crs = \"EPSG:32632\"\nground = \"500 m\""));
  r.dem = folder / "hills.tif";
  r.sets = {"flight.speed=\"70 m/s\""};
  EXPECT_NE(refusal(r).find("both"), std::string::npos);
}

}  // namespace
}  // namespace swath::pipeline
