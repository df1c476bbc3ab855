// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/geo/geodesy.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/geo/ellipsoid_normal.h"

namespace swath::core {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double degree = pi / 180.0;
constexpr double closure = 1e-9;     // m, what the header promises beside rounding
constexpr double last_place = 2e-9;  // m, rounding of coordinates and of a latitude's sine below 16 400 km from the centre

// The same position in extended precision, so that a closure is of the method and not of its check.
void extended_ecef(const Geodetic& g, long double (&p)[3]) {
  const long double f = 1.0L / 298.257223563L, e2 = f * (2 - f);
  const long double s = std::sin(static_cast<long double>(g.latitude)), c = std::cos(static_cast<long double>(g.latitude));
  const long double n = 6378137.0L / std::sqrt(1 - e2 * s * s);
  p[0] = (n + g.height) * c * std::cos(static_cast<long double>(g.longitude));
  p[1] = (n + g.height) * c * std::sin(static_cast<long double>(g.longitude));
  p[2] = (n * (1 - e2) + g.height) * s;
}

TEST(Geodesy, EcefAndBackOverTheGlobe) {
  double worst_ground = 0.0, worst = 0.0;
  for (double lat = -90.0; lat <= 90.0; lat += 0.75)
    for (double lon = -180.0; lon < 180.0; lon += 37.3)
      for (const double h : {-10e3, -100.0, 0.0, 300.0, 3e3, 20e3, 400e3, 2e6, 10e6}) {
        const Geodetic g{lat * degree, lon * degree, h};
        const Eigen::Vector3d p = ecef_of(g);
        const Geodetic back = geodetic_of(p);
        long double q[3];
        extended_ecef(back, q);
        const double miss =
            std::hypot(static_cast<double>(q[0] - p.x()), static_cast<double>(q[1] - p.y()), static_cast<double>(q[2] - p.z()));
        (h <= 20e3 ? worst_ground : worst) = std::max(h <= 20e3 ? worst_ground : worst, miss);
        EXPECT_NEAR(back.height, h, closure + (h <= 20e3 ? 1 : 3) * last_place);
      }
  EXPECT_LT(worst_ground, closure + last_place);
  EXPECT_LT(worst, closure + 2 * last_place);
}

TEST(Geodesy, PolesEquatorAndTheDateLine) {
  EXPECT_NEAR((ecef_of({pi / 2, 0.3, 100.0}) - Eigen::Vector3d(0, 0, 6356752.314245179 + 100.0)).norm(), 0.0, last_place);
  EXPECT_NEAR((ecef_of({0, 0, 5.0}) - Eigen::Vector3d(6378142.0, 0, 0)).norm(), 0.0, last_place);
  const Geodetic south = geodetic_of({0, 0, -6356752.314245179});
  EXPECT_EQ(south.latitude, -pi / 2);
  EXPECT_NEAR(south.height, 0.0, closure);
  EXPECT_NEAR(std::abs(geodetic_of({-6378137.0, 0.0, 0.0}).longitude), pi, 1e-15);
}

// Against PROJ's own conversion EPSG:4978 -> EPSG:4979, an independent implementation; its closure is near 1e-8 m.
TEST(Geodesy, AgreesWithProj) {
  constexpr double proj_closure = 2e-8;  // m
  const Transform t(wgs84_ecef(), wgs84_geodetic());
  for (double lat = -88.0; lat <= 88.0; lat += 11.0) {
    const Eigen::Vector3d p = ecef_of({lat * degree, 0.4, 1234.5});
    const Eigen::Vector3d g = t(p);
    const Geodetic ours = geodetic_of(p);
    EXPECT_NEAR(g.x(), ours.longitude / degree, 1e-13);
    EXPECT_NEAR((g.y() * degree - ours.latitude) * wgs84::a, 0.0, proj_closure);
    EXPECT_NEAR(g.z(), ours.height, proj_closure);
  }
}

// North, east and down are where the position goes when latitude, longitude and -height grow: central differences.
TEST(Geodesy, LocalLevelAxesAreTheSlopesOfThePosition) {
  constexpr double cut = 1e-8;  // of the differences, with rounding 1e-9 m / 10 m
  const Geodetic g{0.81, -2.2, 250.0};
  const Eigen::Matrix3d R = ecef_R_ned(g.latitude, g.longitude);
  EXPECT_LT((R * R.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-15);
  EXPECT_NEAR(R.determinant(), 1.0, 1e-15);
  const double h = 1e-5;
  const auto slope = [&](double dlat, double dlon, double dh) {
    return Eigen::Vector3d(ecef_of({g.latitude + dlat, g.longitude + dlon, g.height + dh}) -
                           ecef_of({g.latitude - dlat, g.longitude - dlon, g.height - dh}));
  };
  EXPECT_LT((slope(h, 0, 0) / (2 * h * (meridian_radius(g.latitude) + g.height)) - R.col(0)).norm(), cut);
  EXPECT_LT((slope(0, h, 0) / (2 * h * (prime_vertical_radius(g.latitude) + g.height) * std::cos(g.latitude)) - R.col(1)).norm(), cut);
  EXPECT_LT((slope(0, 0, -10.0) / 20.0 - R.col(2)).norm(), cut);
}

TEST(Geodesy, TheNormalWithoutAnglesIsThatOfTheAngles) {
  constexpr double of_angles = 4e-15, of_sums = 4e-16, of_gravity = 4e-14;  // rounding: of angles up to pi, of unit vectors, of 9.8 m/s^2
  for (const double latitude : {-pi / 2, -0.9, -1e-9, 0.0, 0.3, 1.2, pi / 2})
    for (const double longitude : {-3.1, -1.0, 0.0, 0.7, 3.14})
      for (const double height : {-100.0, 0.0, 3000.0, 20000.0}) {
        const Eigen::Vector3d place = ecef_of({latitude, longitude, height});
        const Geodetic g = geodetic_of(place);
        const EllipsoidNormal n = ellipsoid_normal(place);
        EXPECT_LT((n.ecef_R_ned() - ecef_R_ned(g.latitude, g.longitude)).norm(), of_angles);
        EXPECT_LT((n.up() + n.ecef_R_ned().col(2)).norm(), of_sums);
        EXPECT_EQ(n.height, g.height);
        EXPECT_NEAR(n.gravity(), normal_gravity(g.latitude, g.height), of_gravity);
      }
  const EllipsoidNormal pole = ellipsoid_normal({0.0, 0.0, wgs84::b + 5.0});
  EXPECT_EQ(pole.cos_longitude, 1.0);
  EXPECT_NEAR(pole.sin_latitude, 1.0, of_sums);
  EXPECT_NEAR(pole.height, 5.0, last_place);
}

TEST(Geodesy, RadiiAtEquatorAndPole) {
  EXPECT_EQ(prime_vertical_radius(0.0), wgs84::a);
  EXPECT_NEAR(meridian_radius(0.0), wgs84::b * wgs84::b / wgs84::a, closure);
  EXPECT_NEAR(meridian_radius(pi / 2), 6399593.6258, 5e-5);  // polar radius of curvature, TR8350.2 table 3.3
  EXPECT_NEAR(prime_vertical_radius(pi / 2), 6399593.6258, 5e-5);
}

TEST(Geodesy, NormalGravity) {
  constexpr double printed = 1e-10;  // m/s^2, places of TR8350.2 table 3.4
  EXPECT_NEAR(normal_gravity(0.0, 0.0), 9.7803253359, printed);
  EXPECT_NEAR(normal_gravity(pi / 2, 0.0), 9.8321849379, printed);
  EXPECT_NEAR(normal_gravity(-pi / 2, 0.0), 9.8321849379, printed);
  // Heiskanen and Moritz 1967 eq. 2-126, heights in km: -(0.30877 - 0.00045 sin^2) h + 0.000072 h^2 gal, for the International ellipsoid.
  constexpr double gal = 1e-2, ellipsoids = 2e-7;  // m/s^2: rounding of the printed coefficients and the other ellipsoid, over 1 km
  EXPECT_NEAR(normal_gravity(pi / 4, 1000.0) - normal_gravity(pi / 4, 0.0), (-(0.30877 - 0.00045 * 0.5) + 0.000072) * gal, ellipsoids);
}

}  // namespace
}  // namespace swath::core
