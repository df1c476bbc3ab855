// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/engine/map_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "core/error.h"

namespace swath::pipeline {
namespace {

/// A run's context with its data at a place in degrees.
stages::Context at(const io::Survey& survey, const char* crs, double longitude, double latitude) {
  stages::Context context{survey};
  context.crs = core::Crs(crs);
  context.unit = context.crs.metres_per_unit();
  const core::Transform to_map(core::wgs84_geodetic().horizontal(), context.crs);
  context.origin = to_map({longitude, latitude, 0.0}) * context.unit;
  context.origin.z() = 0.0;
  return context;
}

std::string fault_of(const stages::Context& context, bool typed = true) {
  try {
    require_map_fit(context, "cloud.las", typed);
  } catch (const core::Error& e) {
    EXPECT_EQ(e.code(), core::Exit::bad_usage);
    return e.text();
  }
  return {};
}

TEST(MapFit, WebMercatorIsRefusedWithTheZoneOfThePlace) {
  const io::Survey survey;
  const std::string text = fault_of(at(survey, "EPSG:3857", 11.0, 48.0));
  for (const char* part : {"cloud.las", "Pseudo-Mercator", "49.6 % longer", "2.2", "--crs EPSG:32632"})
    EXPECT_NE(text.find(part), std::string::npos) << text;
  EXPECT_NE(fault_of(at(survey, "EPSG:3857", 11.0, 48.0), false).find("crs = \"EPSG:32632\""), std::string::npos);
  EXPECT_NE(fault_of(at(survey, "EPSG:3857", 11.0, 60.0)).find("times those on the ground"), std::string::npos);
}

TEST(MapFit, ProjectionsInUseAreNotRefused) {
  const io::Survey survey;
  struct Case {
    const char* crs;
    double longitude, latitude;
    bool warned;
  };
  for (const Case& c : {Case{"EPSG:32632", 6.1, 48.0, false},
                        {"EPSG:25832", 12.0, 55.0, false},
                        {"EPSG:2994", -120.5, 44.0, false},
                        {"EPSG:31370", 4.4, 50.8, false},
                        {"EPSG:3413", -45.0, 61.0, true},
                        {"EPSG:3031", 0.0, -89.0, true},
                        {"EPSG:3035", 25.0, 38.0, true},
                        {"EPSG:3857", 11.0, 12.0, true}}) {
    const stages::Context context = at(survey, c.crs, c.longitude, c.latitude);
    EXPECT_EQ(fault_of(context), "") << c.crs;
    const auto fit = map_fit(context);
    ASSERT_TRUE(fit) << c.crs;
    EXPECT_EQ(std::abs(fit->scale - 1.0) > warned_scale, c.warned) << c.crs << ' ' << fit->scale;
    EXPECT_LE(fit->outside, warned_outside) << c.crs;
  }
}

TEST(MapFit, AnotherZoneIsFarOutside) {
  const io::Survey survey;
  const auto fit = map_fit(at(survey, "EPSG:32632", 20.0, 48.0));
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->outside, 8.0, 0.01);
  EXPECT_NE(outside_warning("WGS 84 / UTM zone 32N", fit->outside).find("8.0 degrees outside"), std::string::npos);
  EXPECT_NE(scale_warning("x", 0.97).find("3 % shorter"), std::string::npos) << scale_warning("x", 0.97);
}

TEST(MapFit, AStrayCornerIsNotHeldAgainstTheMap) {
  const io::Survey survey;
  stages::Context context = at(survey, "EPSG:32632", 9.0, 48.0);
  context.area.box = {context.origin.x() - 1e5, context.origin.y() - 1e5, context.origin.x() + 1e5, context.origin.y() + 1e5};
  context.origin.x() += 4e6;
  EXPECT_EQ(fault_of(context), "");
  EXPECT_NEAR(map_fit(context)->scale, 0.9996, 1e-6);
}

TEST(MapFit, NothingIsSaidWithoutAPlace) {
  const io::Survey survey;
  stages::Context context{survey};
  context.crs = core::Crs("EPSG:3857");
  EXPECT_FALSE(map_fit(context));
  EXPECT_EQ(fault_of(context), "");
}

}  // namespace
}  // namespace swath::pipeline
