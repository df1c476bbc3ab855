// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/las/las_crs.h"

#include <cstring>

#include "core/geo/crs.h"
#include "tests/io/las_sample.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

LasVlr keys(std::initializer_list<std::array<std::uint16_t, 4>> list) {
  LasVlr v{"LASF_Projection", 34735, "", {}, 0, 0};
  v.data.resize(8 * (list.size() + 1));
  const std::array<std::uint16_t, 4> head{1, 1, 0, static_cast<std::uint16_t>(list.size())};
  std::memcpy(v.data.data(), head.data(), 8);
  std::size_t at = 8;
  for (const auto& key : list) std::memcpy(&v.data[at], key.data(), 8), at += 8;
  return v;
}

TEST(LasCrs, FromKeysAndWkt) {
  LasHeader h;
  EXPECT_EQ(las_crs(h).definition, "");
  h.vlrs = {keys({{{1024, 0, 1, 1}}, {{3072, 0, 1, 26910}}})};
  EXPECT_EQ(las_crs(h).definition, "EPSG:26910");
  h.vlrs = {keys({{{2048, 0, 1, 4269}}, {{3072, 0, 1, 2994}}, {{4096, 0, 1, 5703}}, {{4099, 0, 1, 9002}}})};
  EXPECT_EQ(las_crs(h).definition, "EPSG:2994+8228");  // NAVD88 in feet
  EXPECT_DOUBLE_EQ(las_crs(h).vertical_metres, 0.3048);
  h.vlrs = {keys({{{2048, 0, 1, 4326}}, {{4096, 0, 1, 3855}}})};
  EXPECT_EQ(las_crs(h).definition, "EPSG:4326+3855");
  h.vlrs = {keys({{{3072, 0, 1, 32632}}, {{4096, 0, 1, 5030}}})};
  EXPECT_EQ(las_crs(h).definition, "EPSG:32632+ellipsoidal");
  h.vlrs = {keys({{{1024, 0, 1, 3}}, {{2048, 0, 1, 4326}}})};
  EXPECT_EQ(las_crs(h).definition, "EPSG:4978");
  h.vlrs = {keys({{{1024, 0, 1, 3}}, {{2048, 0, 1, 4269}}})};
  EXPECT_EQ(las_crs(h).definition, "");
  h.vlrs = {keys({{{3072, 0, 1, 32767}}})};
  EXPECT_EQ(las_crs(h).definition, "");
  EXPECT_NE(las_crs(h).note.find("not understood"), std::string::npos);
  add_las_wkt(h, "PROJCS[\"x\"]");
  EXPECT_EQ(las_crs(h).definition, "");
  EXPECT_NE(las_crs(h).note.find("the WKT record is not understood"), std::string::npos);
  const std::string wkt = core::Crs("EPSG:25832+7837").wkt1();
  add_las_wkt(h, " " + wkt + "\r\n ");
  EXPECT_EQ(las_crs(h).definition, wkt);
  EXPECT_TRUE(h.global_encoding & las_encoding::wkt);
}

// GeoTIFF 1.0 numbers vertical systems by their datum.
TEST(LasCrs, OldVerticalCodes) {
  LasHeader h;
  const auto of = [&](std::uint16_t horizontal, std::uint16_t vertical, std::uint16_t unit) {
    h.vlrs = {keys({{{1024, 0, 1, 1}}, {{3072, 0, 1, horizontal}}, {{4096, 0, 1, vertical}}, {{4099, 0, 1, unit}}})};
    return las_crs(h).definition;
  };
  EXPECT_EQ(of(26910, 5103, 9001), "EPSG:26910+5703");
  EXPECT_EQ(of(2992, 5103, 9002), "EPSG:2992+8228");
  EXPECT_EQ(of(2927, 5103, 9003), "EPSG:2927+6360");
  EXPECT_EQ(of(2927, 5102, 9003), "EPSG:2927+5702");
  EXPECT_EQ(of(27700, 5101, 9001), "EPSG:27700+5701");
  EXPECT_EQ(of(32632, 5030, 9001), "EPSG:32632+ellipsoidal");
  // A unit beside a system that counts in another: the unit is kept, the system is not.
  EXPECT_EQ(of(27700, 5701, 9002), "EPSG:27700");
  EXPECT_NE(las_crs(h).note.find("the system is not used"), std::string::npos);
  EXPECT_DOUBLE_EQ(las_crs(h).vertical_metres, 0.3048);
  h.vlrs = {keys({{{3072, 0, 1, 26910}}, {{4096, 0, 1, 32767}}, {{4098, 0, 1, 5103}}, {{4099, 0, 1, 9001}}})};
  EXPECT_EQ(las_crs(h).definition, "EPSG:26910+5703");
}

// LAStools writes UTM in feet as the code of the zone and the unit (las2las -utm 10north -feet).
TEST(LasCrs, TheUnitBesideACodeCounts) {
  constexpr double survey_foot = 1200.0 / 3937.0;
  LasHeader h;
  const auto of = [&](std::initializer_list<std::array<std::uint16_t, 4>> rest) {
    h.vlrs = {keys(rest)};
    return core::Crs(las_crs(h).definition);
  };
  const core::Crs plain = of({{{1024, 0, 1, 1}}, {{3072, 0, 1, 26910}}, {{3076, 0, 1, 9003}}});
  EXPECT_NEAR(plain.metres_per_unit(), survey_foot, 1e-15);
  EXPECT_EQ(plain.heights(), core::Heights::unknown);
  // The same place as in metres.
  const core::Transform to_metres(plain, core::Crs("EPSG:26910"));
  const Eigen::Vector3d at = to_metres({600000.0 / survey_foot, 4200000.0 / survey_foot, 0.0});
  EXPECT_NEAR(at.x(), 600000.0, 1e-4);
  EXPECT_NEAR(at.y(), 4200000.0, 1e-4);
  const core::Crs with_heights =
      of({{{1024, 0, 1, 1}}, {{3072, 0, 1, 26910}}, {{3076, 0, 1, 9003}}, {{4096, 0, 1, 5703}}, {{4099, 0, 1, 9003}}});
  EXPECT_NEAR(with_heights.metres_per_unit(), survey_foot, 1e-15);
  EXPECT_EQ(with_heights.vertical_epsg(), 6360);
  EXPECT_NEAR(with_heights.vertical_metres_per_unit(), survey_foot, 1e-15);
  const core::Crs ellipsoidal = of({{{1024, 0, 1, 1}}, {{3072, 0, 1, 26910}}, {{3076, 0, 1, 9002}}, {{4096, 0, 1, 5019}}});
  EXPECT_DOUBLE_EQ(ellipsoidal.metres_per_unit(), 0.3048);
  EXPECT_EQ(ellipsoidal.heights(), core::Heights::ellipsoidal);
  // The code's own unit changes nothing.
  h.vlrs = {keys({{{1024, 0, 1, 1}}, {{3072, 0, 1, 2994}}, {{3076, 0, 1, 9002}}})};
  EXPECT_EQ(las_crs(h).definition, "EPSG:2994");
}

TEST(LasCrs, AnEmptyWktRecordLeavesTheKeys) {
  LasHeader h;
  h.vlrs = {keys({{{1024, 0, 1, 1}}, {{3072, 0, 1, 32632}}}), LasVlr{"LASF_Projection", 2112, "", {0}, 0, 0}};
  EXPECT_EQ(las_crs(h).definition, "EPSG:32632");
  EXPECT_NE(las_crs(h).note.find("the WKT record is empty; the GeoTIFF keys are used"), std::string::npos) << las_crs(h).note;
  h.vlrs.erase(h.vlrs.begin());
  EXPECT_EQ(las_crs(h).definition, "");
  EXPECT_EQ(las_crs(h).note, "the WKT record is empty");
}

// Transverse Mercator on a datum without a name, parameter by parameter: zone 11 of UTM by its projection code.
TEST(LasCrs, KeysThatDefineASystemThemselves) {
  LasHeader h;
  LasVlr numbers{"LASF_Projection", 34736, "", {}, 0, 0}, words{"LASF_Projection", 34737, "", {}, 0, 0};
  const std::array<double, 3> ellipsoid{6378137.0, 298.257223563, 0.0};
  numbers.data.resize(sizeof ellipsoid);
  std::memcpy(numbers.data.data(), ellipsoid.data(), sizeof ellipsoid);
  const std::string name = "zone of ours|";
  words.data.assign(name.begin(), name.end());
  h.vlrs = {keys({{{1024, 0, 1, 1}},
                  {{1026, 34737, 13, 0}},
                  {{2048, 0, 1, 32767}},
                  {{2050, 0, 1, 32767}},
                  {{2054, 0, 1, 9102}},
                  {{2056, 0, 1, 32767}},
                  {{2057, 34736, 1, 0}},
                  {{2059, 34736, 1, 1}},
                  {{2061, 34736, 1, 2}},
                  {{3072, 0, 1, 32767}},
                  {{3074, 0, 1, 16011}},
                  {{3076, 0, 1, 9001}}}),
            numbers, words};
  const core::Crs crs(las_crs(h).definition);
  EXPECT_TRUE(crs.is_projected());
  EXPECT_EQ(crs.heights(), core::Heights::unknown);
  EXPECT_EQ(crs.metres_per_unit(), 1.0);
  EXPECT_NE(crs.wkt().find("-117"), std::string::npos) << crs.wkt();
}

TEST(LasCrs, KeysThatLieAboutTheirNumberAreReadAsFarAsTheyGo) {
  LasHeader h;
  LasVlr v = keys({{{3072, 0, 1, 32632}}});
  v.data[6] = 200;
  h.vlrs = {v};
  EXPECT_EQ(las_crs(h).definition, "EPSG:32632");
}

TEST(LasCrs, OfTheReferenceFiles) {
  SWATH_SHARED_OR_SKIP(data, "data/isprs");
  EXPECT_EQ(LasReader(data / "samp11-utm.laz").crs().definition, "EPSG:32632");
  EXPECT_DOUBLE_EQ(LasReader(data / "samp11-utm.laz").crs().vertical_metres, 1.0);
  EXPECT_EQ(LasReader(data.parent_path() / "autzen/autzen_trim.las").crs().definition.substr(0, 6), "PROJCS");
  EXPECT_EQ(LasReader(data.parent_path() / "als_leeward/points_ecef.las").crs().definition, "EPSG:4978");
  EXPECT_TRUE(core::Crs(LasReader(data.parent_path() / "als_leeward/points.las").crs().definition).is_projected());
}

}  // namespace
}  // namespace swath::io
