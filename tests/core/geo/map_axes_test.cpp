// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/geo/map_axes.h"

#include <gtest/gtest.h>

#include "core/error.h"

namespace swath::core {
namespace {

TEST(MapAxes, EastingAndNorthingInEitherOrder) {
  // UTM, Gauss-Krueger (northing, easting), the poles (axes along meridians), Krovak's form, Swiss, feet, degrees, ECEF.
  for (const char* crs : {"EPSG:32632", "EPSG:31467", "EPSG:3031", "EPSG:3995", "EPSG:32661", "EPSG:32761", "EPSG:5514", "EPSG:2056+5728",
                          "EPSG:2263", "EPSG:4326", "EPSG:4978", "EPSG:25832+ellipsoidal", "+proj=tmerc +lon_0=19 +datum=WGS84"})
    EXPECT_EQ(turned_axes(Crs(crs)), "") << crs;
  EXPECT_EQ(turned_axes(Crs()), "");
  EXPECT_NO_THROW(require_easting_northing(Crs("EPSG:31467"), "crs"));
}

TEST(MapAxes, SouthingAndWesting) {
  EXPECT_EQ(turned_axes(Crs("EPSG:5513")), "southing and westing");
  EXPECT_EQ(turned_axes(Crs("EPSG:5513+ellipsoidal")), "southing and westing");
  EXPECT_EQ(turned_axes(Crs("EPSG:2048")), "westing and southing");
  EXPECT_EQ(turned_axes(Crs("EPSG:3173")), "northing and westing");
  EXPECT_EQ(turned_axes(Crs("EPSG:3053")), "westing and northing");
  EXPECT_EQ(turned_axes(Crs("+proj=tmerc +lon_0=19 +axis=wsu +datum=WGS84")), "westing and southing");
  EXPECT_EQ(turned_axes(Crs(Crs("EPSG:2048").wkt())), "westing and southing");
  const Crs with_own_shift("+proj=tmerc +lon_0=19 +axis=wsu +ellps=bessel +towgs84=1,2,3");
  EXPECT_EQ(turned_axes(with_own_shift), "westing and southing");
}

TEST(MapAxes, FormWithEastingAndNorthing) {
  EXPECT_EQ(easting_northing_form(Crs("EPSG:5513")), "EPSG:5514");
  EXPECT_EQ(easting_northing_form(Crs("EPSG:5513+8357")), "EPSG:5514+8357");
  EXPECT_EQ(easting_northing_form(Crs("EPSG:8352+ellipsoidal")), "EPSG:8353+ellipsoidal");
  EXPECT_EQ(easting_northing_form(Crs("EPSG:2048")), "");
  // The forms differ in nothing else.
  const Eigen::Vector3d place(15.5, 49.5, 0.0);
  const Eigen::Vector3d turned = Transform(wgs84_geodetic().horizontal(), Crs("EPSG:5513"))(place);
  const Eigen::Vector3d map = Transform(wgs84_geodetic().horizontal(), Crs("EPSG:5514"))(place);
  EXPECT_NEAR(map.x(), -turned.y(), 1e-6);
  EXPECT_NEAR(map.y(), -turned.x(), 1e-6);
}

std::string hint_of(const char* crs) {
  try {
    require_easting_northing(Crs(crs), "survey.toml: crs");
  } catch (const Error& e) {
    EXPECT_EQ(e.where(), "survey.toml: crs");
    EXPECT_EQ(e.code(), Exit::bad_usage);
    return e.hint();
  }
  return "accepted";
}

TEST(MapAxes, RefusalNamesAMapToUse) {
  EXPECT_EQ(hint_of("EPSG:5513"), "use EPSG:5514, the same projection with easting and northing; transform coordinates that exist");
  EXPECT_EQ(hint_of("EPSG:2048"), "use such a CRS, for example the UTM zone EPSG:32734; transform coordinates that exist");
  EXPECT_EQ(hint_of(Crs("EPSG:2048").wkt1().c_str()), hint_of("EPSG:2048"));
  EXPECT_EQ(hint_of("EPSG:3173"), "use such a CRS, for example the UTM zone EPSG:32629; transform coordinates that exist");
  EXPECT_EQ(hint_of("+proj=tmerc +lon_0=19 +axis=wsu +datum=WGS84"),
            "use such a CRS, for example the UTM zone EPSG:326xx (north) or EPSG:327xx (south); transform coordinates that exist");
}

TEST(MapAxes, UtmZoneOfAPlaceOrOfTheMiddleOfAMap) {
  EXPECT_EQ(utm_for(Crs("EPSG:4326"), Eigen::Vector2d(10.35, 47.85)), "EPSG:32632");
  EXPECT_EQ(utm_for(Crs("EPSG:4258"), Eigen::Vector2d(10.35, 47.85)), "EPSG:25832");
  EXPECT_EQ(utm_for(Crs("EPSG:2263+6360"), Eigen::Vector2d(983000, 210000)), "EPSG:32618+6360");  // New York, ft
  EXPECT_EQ(utm_for(Crs("EPSG:2263")), "EPSG:32618");
  EXPECT_EQ(utm_for(Crs("EPSG:4326")), "EPSG:326xx (north) or EPSG:327xx (south)");  // the whole globe has no zone
}

}  // namespace
}  // namespace swath::core
