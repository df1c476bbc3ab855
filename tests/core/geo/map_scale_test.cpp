// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/geo/map_scale.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/geo/geodesy.h"

namespace swath::core {
namespace {

/// Map coordinates of a place.
Eigen::Vector2d on(const char* crs, double longitude, double latitude) {
  return Transform(wgs84_geodetic().horizontal(), Crs(crs))({longitude, latitude, 0.0}).head<2>();
}

TEST(MapScale, OfUtmByItsFormulas) {
  EXPECT_NEAR(map_scale(Crs("EPSG:32632"), {500000.0, 5300000.0})->worst(), 0.9996, 1e-7);  // the central meridian
  // k = k0 (1 + x^2 / 2 R^2), Snyder 1987 (8-14) to its first term; the next is 1e-8 here.
  const double x = 150000.0, radius = 6378137.0 * (1.0 - 0.5 * wgs84::e2);
  EXPECT_NEAR(map_scale(Crs("EPSG:32632"), {500000.0 + x, 5300000.0})->worst(), 0.9996 * (1.0 + 0.5 * x * x / (radius * radius)), 3e-6);
}

TEST(MapScale, OfWebMercatorGrowsWithLatitude) {
  const Eigen::Vector2d at = on("EPSG:3857", 11.0, 48.0);
  const MapScale k = *map_scale(Crs("EPSG:3857"), at);
  EXPECT_NEAR(k.worst(), 1.0 / std::cos(48.0 * std::numbers::pi / 180.0), 5e-3);  // the sphere's; the ellipsoid adds up to 0.7 %
  EXPECT_NEAR(k.area(), 2.23, 0.01);
  // By the ellipsoid's radii of curvature: a / (N cos) and a / (M cos).
  const double w = 1.0 - wgs84::e2 * std::pow(std::sin(48.0 * std::numbers::pi / 180.0), 2);
  const double along_parallel = std::sqrt(w) / std::cos(48.0 * std::numbers::pi / 180.0);
  EXPECT_NEAR(k.smallest, along_parallel, 1e-7);
  EXPECT_NEAR(k.largest, along_parallel * w / (1.0 - wgs84::e2), 1e-7);
  EXPECT_NEAR(map_scale(Crs("EPSG:3857"), on("EPSG:3857", 11.0, 0.0))->worst(), 1.0, 7e-3);
}

TEST(MapScale, OfAPolarMapAtThePoleAndInFeet) {
  EXPECT_NEAR(map_scale(Crs("EPSG:3031"), {0.0, 0.0})->worst(), 0.9728, 1e-3);                  // true at 71 S
  EXPECT_NEAR(map_scale(Crs("EPSG:2994"), on("EPSG:2994", -120.5, 44.0))->worst(), 1.0, 2e-3);  // Oregon, feet
}

TEST(MapScale, OfAMapInGradsFromParis) {
  const Eigen::Vector2d at(600000.0, 2200000.0);  // NTF (Paris) / Lambert zone II: its origin
  const Place place = *place_on_earth(Crs("EPSG:27572"), at);
  EXPECT_NEAR(place.longitude, 2.33722917, 1e-6);
  EXPECT_NEAR(place.latitude, 46.8, 1e-6);
  EXPECT_NEAR(map_scale(Crs("EPSG:27572"), at)->worst(), 0.99987742, 1e-7);
}

TEST(MapScale, WhatIsNoMapHasNone) {
  EXPECT_FALSE(map_scale(Crs("EPSG:4326"), {11.0, 48.0}));
  EXPECT_FALSE(place_on_earth(Crs("EPSG:4978"), {4e6, 8e5}));
  EXPECT_FALSE(map_scale(Crs(), {0.0, 0.0}));
  EXPECT_FALSE(map_scale(Crs("EPSG:32632"), {1e12, 1e12}));
}

TEST(MapScale, AreasOfUseAlsoAcrossTheAntimeridian) {
  EXPECT_EQ(degrees_outside(Crs("EPSG:32632"), {9.0, 48.0}), 0.0);
  EXPECT_NEAR(degrees_outside(Crs("EPSG:32632"), {15.0, 48.0}), 3.0, 1e-9);
  EXPECT_NEAR(degrees_outside(Crs("EPSG:32660"), {-179.0, 48.0}), 1.0, 1e-9);
  EXPECT_NEAR(degrees_outside(Crs("EPSG:32632"), {9.0, -10.0}), 10.0, 1e-9);
  EXPECT_EQ(degrees_outside(Crs("EPSG:3460"), {-179.0, -17.0}), 0.0);  // Fiji, 176.81 E to 178.15 W
}

TEST(MapScale, UtmZones) {
  EXPECT_EQ(utm_zone({11.0, 48.0}), "EPSG:32632");
  EXPECT_EQ(utm_zone({11.0, -17.0}), "EPSG:32732");
  EXPECT_EQ(utm_zone({180.0, -17.0}), "EPSG:32701");
  EXPECT_EQ(utm_zone({179.9, -17.0}), "EPSG:32760");
  EXPECT_EQ(utm_zone({359.0, 10.0}), "EPSG:32630");
  EXPECT_EQ(utm_zone({11.0, 48.0}, Crs("EPSG:4258")), "EPSG:25832");
  EXPECT_EQ(utm_zone({100.0, 48.0}, Crs("EPSG:4258")), "EPSG:32647");
  EXPECT_EQ(utm_zone({0.0, 88.0}), "EPSG:326xx");
}

}  // namespace
}  // namespace swath::core
