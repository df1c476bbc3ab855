// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/geo/crs.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/geo/geodesy.h"
#include "tests/core/geo/crs_support.h"
#include "tests/world/support.h"

namespace swath::core {
namespace {

constexpr double degree = std::numbers::pi / 180.0;
constexpr double micrometre = 1e-6;  // m: series of projections, printed constants of PROJ's ellipsoids

TEST(Crs, FactsOfAProjectedCrs) {
  const Crs crs("EPSG:32632");
  EXPECT_EQ(crs.name(), "WGS 84 / UTM zone 32N");
  EXPECT_EQ(crs.epsg(), 32632);
  EXPECT_EQ(crs.vertical_epsg(), 0);
  EXPECT_TRUE(crs.is_projected());
  EXPECT_FALSE(crs.is_geographic() || crs.is_geocentric() || crs.has_vertical());
  EXPECT_EQ(crs.heights(), Heights::unknown);
  EXPECT_EQ(crs.vertical_name(), "height system not stated");
  EXPECT_EQ(crs.metres_per_unit(), 1.0);
  EXPECT_EQ(crs.unit_name(), "metre");
  double w = 0, s = 0, e = 0, n = 0;
  ASSERT_TRUE(crs.area_of_use(w, s, e, n));
  EXPECT_EQ(w, 6.0);
  EXPECT_EQ(e, 12.0);
  EXPECT_EQ(s, 0.0);
  EXPECT_EQ(n, 84.0);
}

TEST(Crs, CompoundInBothSpellings) {
  for (const char* text : {"EPSG:25832+7837", "EPSG:25832+EPSG:7837", " epsg:25832+epsg:7837\n"}) {
    const Crs crs(text);
    EXPECT_EQ(crs.epsg(), 25832) << text;
    EXPECT_EQ(crs.vertical_epsg(), 7837) << text;
    EXPECT_TRUE(crs.has_vertical() && crs.is_projected());
    EXPECT_EQ(crs.vertical_name(), "Deutsches Haupthoehennetz 2016");
    EXPECT_EQ(crs.vertical_metres_per_unit(), 1.0);
    EXPECT_EQ(crs.key(), Crs("EPSG:25832+7837").key());
  }
}

TEST(Crs, FeetOfBothKinds) {
  const Crs international("EPSG:2992"), survey("EPSG:2927"), feet_up("EPSG:6557+6360");
  EXPECT_EQ(international.unit_name(), "foot");
  EXPECT_EQ(international.metres_per_unit(), 0.3048);
  EXPECT_EQ(survey.unit_name(), "US survey foot");
  EXPECT_NEAR(survey.metres_per_unit(), 1200.0 / 3937.0, 1e-15);
  EXPECT_EQ(international.vertical_metres_per_unit(), 1.0);
  EXPECT_EQ(international.vertical_unit_name(), "metre");
  EXPECT_NEAR(feet_up.vertical_metres_per_unit(), 1200.0 / 3937.0, 1e-15);
  EXPECT_EQ(feet_up.vertical_unit_name(), "US survey foot");
}

TEST(Crs, GeographicAndGeocentric) {
  EXPECT_TRUE(wgs84_geodetic().is_geographic());
  EXPECT_EQ(wgs84_geodetic().metres_per_unit(), 0.0);
  EXPECT_EQ(wgs84_geodetic().unit_name(), "degree");
  EXPECT_EQ(wgs84_geodetic().vertical_metres_per_unit(), 1.0);
  EXPECT_TRUE(wgs84_ecef().is_geocentric());
  EXPECT_EQ(wgs84_ecef().metres_per_unit(), 1.0);
  EXPECT_TRUE(Crs().empty());
  EXPECT_THROW(Crs().name(), Error);
}

TEST(Crs, WktComesBackInBothForms) {
  for (const char* text : {"EPSG:32632", "EPSG:25832+7837", "EPSG:2992", "EPSG:4979", "EPSG:4978", "+proj=utm +zone=32 +datum=WGS84"}) {
    const Crs crs(text);
    EXPECT_EQ(Crs(crs.wkt()).wkt(), crs.wkt()) << text;
    const Crs from_wkt1(crs.wkt1() + std::string(1, '\0'));  // as a LAS record ends it
    EXPECT_EQ(from_wkt1.epsg(), crs.epsg()) << text;
    EXPECT_EQ(from_wkt1.vertical_epsg(), crs.vertical_epsg()) << text;
    EXPECT_EQ(from_wkt1.metres_per_unit(), crs.metres_per_unit()) << text;
  }
  EXPECT_EQ(Crs("EPSG:25832+7837").wkt1().rfind("COMPD_CS[", 0), 0u);
  EXPECT_EQ(Crs("EPSG:32632").wkt().rfind("PROJCRS[", 0), 0u);
}

// As older software writes LAS files: the ESRI and the bare GDAL form, without authorities.
TEST(Crs, ReadsWkt1WithoutAuthorities) {
  const std::string geographic =
      R"(GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563]],PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]])";
  const std::string parameters =
      R"(PROJECTION["Transverse_Mercator"],PARAMETER["latitude_of_origin",0],PARAMETER["central_meridian",9],PARAMETER["scale_factor",0.9996],)"
      R"(PARAMETER["false_easting",500000],PARAMETER["false_northing",0],UNIT["metre",1]])";
  const std::string esri =
      R"(PROJCS["WGS_1984_UTM_Zone_32N",GEOGCS["GCS_WGS_1984",DATUM["D_WGS_1984",SPHEROID["WGS_1984",6378137.0,298.257223563]],)"
      R"(PRIMEM["Greenwich",0.0],UNIT["Degree",0.0174532925199433]],PROJECTION["Transverse_Mercator"],PARAMETER["False_Easting",500000.0],)"
      R"(PARAMETER["False_Northing",0.0],PARAMETER["Central_Meridian",9.0],PARAMETER["Scale_Factor",0.9996],)"
      R"(PARAMETER["Latitude_Of_Origin",0.0],UNIT["Meter",1.0]])";
  for (const std::string& wkt : {"PROJCS[\"WGS 84 / UTM zone 32N\"," + geographic + "," + parameters, esri}) {
    const Crs crs(wkt);
    EXPECT_TRUE(crs.is_projected());
    const Eigen::Vector3d m = Transform(wgs84_ecef(), crs)(ecef_of({50.0 * degree, 8.0 * degree, 120.0}));
    EXPECT_LT((m.head<2>() - utm_by_krueger(50.0 * degree, 8.0 * degree, 9.0 * degree)).norm(), micrometre);
    EXPECT_NEAR(m.z(), 120.0, micrometre);
  }
}

TEST(Crs, RefusesWhatIsNoCrs) {
  EXPECT_TRUE(has(refusal([] { Crs("EPSG:999999"); }), "PROJ's database does not hold the CRS \"EPSG:999999\""));
  EXPECT_TRUE(has(refusal([] { Crs("EPSG:25832+99999"); }), "PROJ's database does not hold the CRS \"EPSG:99999\""));
  EXPECT_TRUE(has(refusal([] { Crs("epsg:102003"); }), "\"ESRI:102003\""));
  for (const char* unknown : {"EPSG:999999", "no such thing"})
    EXPECT_FALSE(has(refusal([unknown] { (void)Crs(unknown); }), "Unknown error")) << unknown;
  EXPECT_TRUE(has(refusal([] { Crs("32632"); }), "\"EPSG:32632\""));
  EXPECT_TRUE(has(refusal([] { Crs(""); }), "empty"));
  EXPECT_TRUE(has(refusal([] { Crs("no such thing"); }), "no such thing"));
  EXPECT_TRUE(has(refusal([] { Crs("EPSG:4979+5773"); }), "two-dimensional"));
  EXPECT_TRUE(has(refusal([] { Crs("EPSG:7837"); }), "join it to a horizontal CRS"));
  EXPECT_TRUE(has(refusal([] { Crs("EPSG:7030"); }), "EPSG:7030"));  // an ellipsoid
  EXPECT_TRUE(has(refusal([] { Crs("PROJCS[\"cut"); }), "WKT is damaged"));
  EXPECT_TRUE(has(refusal([] { Crs("+proj=pipeline +step +proj=utm +zone=32"); }), "pipeline"));
}

TEST(Crs, EllipsoidalHeightsAreStated) {
  const Crs crs("EPSG:32632+ellipsoidal");
  EXPECT_EQ(crs.epsg(), 32632);
  EXPECT_EQ(crs.heights(), Heights::ellipsoidal);
  EXPECT_EQ(crs.vertical_name(), "ellipsoidal height");
  EXPECT_TRUE(crs.has_height_unit() && !crs.has_vertical() && crs.is_projected());
  EXPECT_EQ(crs.horizontal().heights(), Heights::unknown);
  for (const std::string& text : {crs.wkt(), crs.wkt1()}) {
    EXPECT_EQ(Crs(text).heights(), Heights::ellipsoidal) << text;
    EXPECT_TRUE(Crs(text).is_projected());
  }
  EXPECT_EQ(crs.wkt1().rfind("COMPD_CS[", 0), 0u);  // as LAS wants it, WKT1
  EXPECT_EQ(Crs("EPSG:32632+4979").heights(), Heights::ellipsoidal);
  EXPECT_EQ(wgs84_geodetic().heights(), Heights::ellipsoidal);
  EXPECT_EQ(wgs84_ecef().heights(), Heights::ellipsoidal);
  EXPECT_EQ(Crs("EPSG:25832+7837").heights(), Heights::vertical);
  EXPECT_EQ(Crs("EPSG:25832+7837").horizontal().epsg(), 25832);
  EXPECT_TRUE(has(refusal([] { Crs("EPSG:25832+7837+ellipsoidal"); }), "vertical part already"));
  EXPECT_NEAR(Transform(wgs84_ecef(), crs)(ecef_of({50.0 * degree, 8.0 * degree, 120.0})).z(), 120.0, micrometre);
}

std::string compound_of(const std::string& vertical) {
  return R"(COMPD_CS["WGS 84 / UTM zone 10N + VERT_CS",PROJCS["WGS 84 / UTM zone 10N",GEOGCS["WGS 84",DATUM["WGS_1984",)"
         R"(SPHEROID["WGS 84",6378137,298.257223563,AUTHORITY["EPSG","7030"]],TOWGS84[0,0,0,0,0,0,0],AUTHORITY["EPSG","6326"]],)"
         R"(PRIMEM["Greenwich",0,AUTHORITY["EPSG","8901"]],UNIT["degree",0.0174532925199433,AUTHORITY["EPSG","9122"]],)"
         R"(AUTHORITY["EPSG","4326"]],PROJECTION["Transverse_Mercator"],PARAMETER["latitude_of_origin",0],)"
         R"(PARAMETER["central_meridian",-123],PARAMETER["scale_factor",0.9996],PARAMETER["false_easting",500000],)"
         R"(PARAMETER["false_northing",0],UNIT["metre",1,AUTHORITY["EPSG","9001"]],AXIS["X",EAST],AXIS["Y",NORTH],)"
         R"(AUTHORITY["EPSG","32610"]],)" +
         vertical + "]";
}

// As LAStools and others write LAS files.
TEST(Crs, CompoundsOfLasFiles) {
  const Crs navd(compound_of(R"(VERT_CS["NAVD88",VERT_DATUM["North American Vertical Datum 1988",2005,AUTHORITY["EPSG","5103"]],)"
                             R"(UNIT["metre",1.0,AUTHORITY["EPSG","9001"]],AXIS["Gravity-related height",UP],AUTHORITY["EPSG","5703"]])"));
  EXPECT_EQ(navd.epsg(), 32610);
  EXPECT_EQ(navd.vertical_epsg(), 5703);
  EXPECT_EQ(navd.heights(), Heights::vertical);
  EXPECT_EQ(navd.wkt().find("BOUNDCRS"), std::string::npos);  // the null shift beside a known datum
  EXPECT_EQ(Crs(navd.wkt1()).vertical_epsg(), 5703);
  // A unit and no system.
  const Crs open(compound_of(R"(VERT_CS["unknown",VERT_DATUM["unknown",2005],UNIT["US survey foot",0.304800609601219],AXIS["Up",UP]])"));
  EXPECT_EQ(open.heights(), Heights::unknown);
  EXPECT_EQ(open.vertical_name(), "height system not stated");
  EXPECT_TRUE(open.has_height_unit());
  EXPECT_NEAR(open.vertical_metres_per_unit(), 1200.0 / 3937.0, 1e-12);
  const Crs ellipsoid(compound_of(R"(VERT_CS["Ellipsoid",VERT_DATUM["Ellipsoid",2002],UNIT["metre",1],AXIS["Up",UP]])"));
  EXPECT_EQ(ellipsoid.heights(), Heights::ellipsoidal);
}

}  // namespace
}  // namespace swath::core
