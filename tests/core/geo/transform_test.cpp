// SPDX-License-Identifier: GPL-3.0-or-later
// Transformations between CRSs.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>
#include <thread>
#include <vector>

#include "core/geo/crs.h"
#include "core/geo/geodesy.h"
#include "tests/core/geo/crs_support.h"
#include "tests/world/support.h"

namespace swath::core {
namespace {

constexpr double degree = std::numbers::pi / 180.0;
constexpr double micrometre = 1e-6;       // m: series of projections, printed constants of PROJ's ellipsoids
constexpr double projection_back = 5e-6;  // m: PROJ 9.1's inverse transverse Mercator closes to 1.1e-6 m
constexpr double grs80 = 1.1e-4;          // m: the semi-minor axes of WGS 84 and GRS 80 differ by 1.05e-4 m, and so do heights

/// A geoid grid (GTX, big-endian) over 8..10 E, 49..51 N with heights 40 + 2 (lat - 49) + (lon - 8) m: bilinear interpolation is exact.
void write_geoid(const std::filesystem::path& file) {
  std::string bytes;
  const auto put = [&](auto bits) {
    for (int shift = static_cast<int>(sizeof bits) * 8 - 8; shift >= 0; shift -= 8)
      bytes.push_back(static_cast<char>((bits >> shift) & 0xff));
  };
  for (const double v : {49.0, 8.0, 0.25, 0.25}) put(std::bit_cast<std::uint64_t>(v));
  put(std::uint32_t{9});
  put(std::uint32_t{9});
  for (int row = 0; row < 9; ++row)
    for (int column = 0; column < 9; ++column)
      put(std::bit_cast<std::uint32_t>(40.0f + 0.5f * static_cast<float>(row) + 0.25f * static_cast<float>(column)));
  test::write_bytes(file, bytes);
}

TEST(Transform, EcefToUtmAgainstKruegerAndKeepsHeights) {
  const Transform to_map(wgs84_ecef(), Crs("EPSG:32632"));
  const Transform back(Crs("EPSG:32632"), wgs84_ecef());
  for (double lat = 1.0; lat < 84.0; lat += 5.5)
    for (double lon = 6.0; lon <= 12.0; lon += 1.5)
      for (const double h : {-50.0, 0.0, 1234.5, 9000.0}) {
        const Eigen::Vector3d p = ecef_of({lat * degree, lon * degree, h});
        const Eigen::Vector3d m = to_map(p);
        EXPECT_LT((m.head<2>() - utm_by_krueger(lat * degree, lon * degree, 9.0 * degree)).norm(), micrometre) << lat << ' ' << lon;
        EXPECT_NEAR(m.z(), h, micrometre);
        EXPECT_LT((back(m) - p).norm(), projection_back);
      }
}

TEST(Transform, AxesAreEastingNorthingAndDegreesLongitudeFirst) {
  const Eigen::Vector3d g = Transform(wgs84_ecef(), wgs84_geodetic())(ecef_of({50.0 * degree, 9.5 * degree, 100.0}));
  EXPECT_NEAR(g.x(), 9.5, 1e-12);
  EXPECT_NEAR(g.y(), 50.0, 1e-12);
  EXPECT_NEAR(Transform(Crs("EPSG:4326"), Crs("EPSG:31468"))({12.0, 48.0, 0.0}).x(), 4.5e6, 500.0);  // northing first in EPSG
}

// EPSG guidance note 7-2 (2019), Lambert conic conformal (2SP): NAD27 / Texas South Central, US survey feet; the projection alone.
TEST(Transform, LambertInFeetAgainstThePublishedExample) {
  const Transform t(Crs("EPSG:4267"), Crs("EPSG:32040"));
  const Eigen::Vector3d m = t({-96.0, 28.5, 100.0});
  EXPECT_NEAR(m.x(), 2963503.91, 0.005);
  EXPECT_NEAR(m.y(), 254759.80, 0.005);
  EXPECT_NEAR(m.z(), 100.0, micrometre);
}

TEST(Transform, EllipsoidalHeightsStayMetresOverFeet) {
  const Eigen::Vector3d ft = Transform(wgs84_ecef(), Crs("EPSG:6557"))(ecef_of({44.0 * degree, -123.0 * degree, 250.0}));
  const Eigen::Vector3d m = Transform(wgs84_ecef(), Crs("EPSG:6556"))(ecef_of({44.0 * degree, -123.0 * degree, 250.0}));
  constexpr double printed_easting = 5e-6;  // m: EPSG gives the false easting as 1312335.958 ft against 400000 m
  EXPECT_NEAR(ft.x() * 0.3048, m.x(), printed_easting);
  EXPECT_NEAR(ft.y() * 0.3048, m.y(), printed_easting);
  EXPECT_NEAR(ft.z(), 250.0, grs80);
}

TEST(Transform, AppliesAGeoidGrid) {
  const test::TemporaryFolder folder;
  write_geoid(folder / "made.gtx");
  const Crs map("+proj=utm +zone=32 +datum=WGS84 +geoidgrids=" + (folder / "made.gtx").string());
  EXPECT_TRUE(map.has_vertical());
  const Transform up(wgs84_ecef(), map), down(map, wgs84_ecef());
  for (const double lat : {49.1, 49.7, 50.9})
    for (const double lon : {8.1, 9.0, 9.7}) {
      const Eigen::Vector3d p = ecef_of({lat * degree, lon * degree, 312.5});
      const Eigen::Vector3d m = up(p);
      EXPECT_NEAR(m.z(), 312.5 - (40.0 + 2.0 * (lat - 49.0) + (lon - 8.0)), 5e-6);  // heights in the grid are 4-byte: 4e-6 m
      EXPECT_LT((m.head<2>() - utm_by_krueger(lat * degree, lon * degree, 9.0 * degree)).norm(), micrometre);
      EXPECT_LT((down(m) - p).norm(), projection_back);
    }
  // Outside the grid there is no height: an error or a counted NaN, never the ellipsoidal height.
  const Eigen::Vector3d off = ecef_of({52.0 * degree, 9.0 * degree, 312.5});
  EXPECT_TRUE(has(refusal([&] { up(off); }), "grid's area"));
  std::vector<double> x{off.x(), off.x()}, y{off.y(), off.y()}, z{off.z(), off.z()};
  const Eigen::Vector3d in = ecef_of({50.0 * degree, 9.0 * degree, 312.5});
  x[1] = in.x(), y[1] = in.y(), z[1] = in.z();
  EXPECT_EQ(up.apply(x.data(), y.data(), z.data(), 2), 1u);
  EXPECT_TRUE(std::isnan(x[0]) && std::isnan(y[0]) && std::isnan(z[0]));
  EXPECT_NEAR(z[1], 312.5 - 43.0, 5e-6);
}

// Geoid heights that NGA publishes with its EGM96 program (F477 OUTPUT.DAT), from the full series; PROJ has the grid of 15'.
TEST(Transform, AppliesEgm96WhereItsGridIsInstalled) {
  constexpr double of_the_grid = 0.15;  // m, bilinear interpolation in 15' cells
  std::optional<Transform> t;
  try {
    t.emplace(wgs84_geodetic(), Crs("EPSG:4326+5773"));
  } catch (const Error& e) {
    GTEST_SKIP() << e.text();
  }
  struct Published {
    double lat, lon, undulation;
  };
  for (const auto& [lat, lon, undulation] : {Published{38.628155, -90.220845, -31.628}, Published{-14.621217, -54.978886, -2.969},
                                             Published{46.874319, 102.448729, -43.575}, Published{-23.617446, 133.874712, 15.871}})
    EXPECT_NEAR((*t)({lon, lat, 100.0}).z(), 100.0 - undulation, of_the_grid) << lat << ' ' << lon;
}

TEST(Transform, RefusesAMissingGeoidGrid) {
  const std::string german = refusal([] { Transform(wgs84_ecef(), Crs("EPSG:25832+7837")); });
  if (!german.empty()) {
    EXPECT_TRUE(has(german, "GCG2016") || has(german, "gcg2016")) << german;
    EXPECT_TRUE(has(german, "PROJ_DATA")) << german;
  }
  for (const char* prefix : {"", "@"}) {  // "@" makes a grid optional: heights would pass through untouched
    const std::string text = refusal(
        [&] { Transform(wgs84_ecef(), Crs(std::string("+proj=utm +zone=32 +datum=WGS84 +geoidgrids=") + prefix + "/nowhere/made.gtx")); });
    EXPECT_TRUE(has(text, "/nowhere/made.gtx")) << text;
  }
  // From a levelled height to an ellipsoidal one, and between two levels.
  EXPECT_TRUE(has(refusal([] { Transform(Crs("EPSG:25832+7837"), Crs("EPSG:25832+ellipsoidal")); }), "grid file"));
  refusal([] { Transform(Crs("EPSG:25832+7837"), Crs("EPSG:25832+5773")); });
}

// A cloud in UTM without a height system was moved by the geoid's 48.55 m.
TEST(Transform, HeightsOfAnUnknownSystemAreNeverShifted) {
  for (const auto& [from, to] : {std::pair{"EPSG:32632", "EPSG:32632+5773"}, {"EPSG:32632+5773", "EPSG:32632"}}) {
    const std::string text = refusal([&] { Transform(Crs(from), Crs(to)); });
    EXPECT_TRUE(has(text, "does not state its height system")) << text;
    EXPECT_TRUE(has(text, "\"EPSG:32632+5773\"") && has(text, "\"EPSG:32632+ellipsoidal\"")) << text;
  }
  // Neither states one: heights go through, whatever the datums.
  const Eigen::Vector3d p = Transform(Crs("EPSG:32632"), Crs("EPSG:31467"))({500123.25, 5.4e6, 77.125});
  EXPECT_EQ(p.z(), 77.125);
  EXPECT_GT(std::abs(p.x() - 500123.25), 1.0);
  const Transform copy = Transform(Crs("EPSG:32632"), Crs("EPSG:32633")).copy();
  EXPECT_EQ(copy({500123.25, 5.4e6, -3.5}).z(), -3.5);
}

TEST(Transform, RefusesTheSecondBestWhereABetterGridIsMissing) {
  // OSTN15 (1 m against WGS 84) is not among the grids of a plain installation; PROJ alone would take the Helmert of 2 m.
  const Crs britain("EPSG:27700");
  try {
    const Transform t(wgs84_ecef(), britain);
    EXPECT_LE(t.accuracy(), 1.0);
  } catch (const Error& e) {
    EXPECT_TRUE(has(e.text(), "OSTN15")) << e.text();
  }
}

TEST(Transform, TakesACoarseNullShiftAndSaysSo) {
  const Transform t(wgs84_ecef(), Crs("EPSG:2992"));
  const Eigen::Vector3d p = t(ecef_of({44.0 * degree, -123.0 * degree, 250.0}));
  const Eigen::Vector3d q = Transform(Crs("EPSG:4269"), Crs("EPSG:2992"))({-123.0, 44.0, 250.0});
  constexpr double wgs84_to_nad83 = 10.0;  // ft: the two frames differ by some 1.5 m
  EXPECT_LT((p - q).norm(), wgs84_to_nad83);
  EXPECT_GE(t.accuracy(), 1.0);
}

TEST(Transform, RefusesBallpark) {
  EXPECT_TRUE(has(refusal([] { Transform(wgs84_ecef(), Crs("+proj=utm +zone=32 +ellps=GRS67")); }), "datum"));
  EXPECT_THROW(Transform(Crs(), wgs84_ecef()), Error);
}

TEST(Transform, SameCrsChangesNothing) {
  const Eigen::Vector3d p(500123.25, 5.6e6, 77.0);
  EXPECT_LT((Transform(Crs("EPSG:25832+7837"), Crs("EPSG:25832+7837"))(p) - p).norm(), micrometre);
  EXPECT_TRUE(
      std::isfinite(Transform(wgs84_geodetic(), Crs("+proj=merc +a=6378137 +b=6378137 +nadgrids=@null +wktext"))({9.0, 50.0, 1.0}).x()));
  EXPECT_LT((Transform(Crs("EPSG:32632"), Crs("EPSG:32632"))(p) - p).norm(), micrometre);
}

TEST(Transform, EcefAndGeodeticSourcesAgreeWhereProjHasAChoice) {
  constexpr double helmert_back = 1e-3;  // m: small-angle Helmerts are not exactly inverse
  for (const char* code : {"EPSG:2927", "EPSG:28992", "EPSG:25832", "EPSG:2056", "EPSG:7855", "EPSG:23032"}) {
    const Crs map(code);
    double w = 0, s = 0, e = 0, n = 0;
    ASSERT_TRUE(map.area_of_use(w, s, e, n));
    try {
      const Transform from_ecef(wgs84_ecef(), map), from_geodetic(wgs84_geodetic(), map);
      for (const double part : {0.35, 0.5, 0.6}) {
        const double lon = w + part * (e - w), lat = s + part * (n - s);
        const Eigen::Vector3d a = from_ecef(ecef_of({lat * degree, lon * degree, 80.0})), b = from_geodetic({lon, lat, 80.0});
        EXPECT_LT((a - b).norm(), 1.2 * grs80) << code << " at " << lon << ' ' << lat << "\n"
                                               << from_ecef.description() << "\n"
                                               << from_geodetic.description();
        const Eigen::Vector3d back = Transform(map, wgs84_ecef())(a);
        EXPECT_LT((back - ecef_of({lat * degree, lon * degree, 80.0})).norm(), helmert_back) << code;
      }
    } catch (const Error& error) {
      EXPECT_TRUE(has(error.text(), "grid file")) << error.text();
    }
  }
}

TEST(Transform, CopiesWorkInOtherThreads) {
  const Transform t(wgs84_ecef(), Crs("EPSG:2927"));
  const Eigen::Vector3d p = ecef_of({46.5 * degree, -122.0 * degree, 80.0});
  const Eigen::Vector3d expected = t(p);
  std::vector<Transform> copies;
  for (int i = 0; i < 4; ++i) copies.push_back(t.copy());
  std::vector<double> worst(4, -1.0);
  std::vector<std::thread> threads;
  for (size_t k = 0; k < 4; ++k)
    threads.emplace_back([&, k] {
      for (int i = 0; i < 2000; ++i) worst[k] = std::max(worst[k], (copies[k](p) - expected).norm());
    });
  for (std::thread& thread : threads) thread.join();
  for (const double w : worst) EXPECT_EQ(w, 0.0);
}

TEST(Transform, RefusesPointsWithoutAResult) {
  const Transform t(wgs84_geodetic(), Crs("EPSG:32632"));
  EXPECT_TRUE(has(refusal([&] { t({9.0, 120.0, 0.0}); }), "no result"));
  EXPECT_TRUE(has(refusal([&] { t({std::numeric_limits<double>::quiet_NaN(), 50.0, 0.0}); }), "no result"));
  EXPECT_NEAR(t({9.0, 50.0, 7.0}).z(), 7.0, micrometre);  // works on after a failure
}

TEST(Transform, NamesItsOperation) {
  const Transform t(wgs84_ecef(), Crs("EPSG:32632"));
  EXPECT_TRUE(has(t.description(), "UTM zone 32N")) << t.description();
  EXPECT_EQ(t.accuracy(), 0.0);
}

}  // namespace
}  // namespace swath::core
