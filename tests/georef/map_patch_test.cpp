// SPDX-License-Identifier: GPL-3.0-or-later
#include "georef/map_patch.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include <cmath>
#include <cstring>
#include <random>
#include <thread>

#include "core/config/units.h"
#include "tests/calib/reference_data.h"

namespace swath::test {}
namespace swath::georef {
namespace test {
using namespace swath::calib::test;
using namespace swath::test;
}  // namespace test
namespace {

using Eigen::Vector3d;
constexpr double deg = core::degree;
constexpr double tenth_of_a_millimetre = 1e-4;

struct Points {
  std::vector<double> x, y, z;
};

// Points over a survey of `size` degrees around a place, heights 0 to 1500 m.
Points survey(double latitude, double longitude, double size, size_t n, unsigned seed = 1) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  Points p;
  for (size_t i = 0; i < n; ++i) {
    const Vector3d e = core::ecef_of(
        {(latitude + size * (unit(random) - 0.5)) * deg, (longitude + size * (unit(random) - 0.5)) * deg, 1500.0 * unit(random)});
    p.x.push_back(e.x()), p.y.push_back(e.y()), p.z.push_back(e.z());
  }
  return p;
}

// Largest difference of a coordinate to PROJ, m.
double worst(const core::Crs& crs, const Points& points, MapPatches::Made* made = nullptr) {
  const MapPatches patches(crs);
  Points a = points, b = points;
  const size_t n = points.x.size();
  EXPECT_EQ(patches.apply(a.x.data(), a.y.data(), a.z.data(), n), 0u);
  EXPECT_EQ(core::Transform(core::wgs84_ecef(), crs).apply(b.x.data(), b.y.data(), b.z.data(), n), 0u);
  const double horizontal = crs.metres_per_unit() > 0.0 ? crs.metres_per_unit() : 111320.0;
  double out = 0.0;
  for (size_t i = 0; i < n; ++i)
    out = std::max({out, horizontal * std::abs(a.x[i] - b.x[i]), horizontal * std::abs(a.y[i] - b.y[i]),
                    crs.vertical_metres_per_unit() * std::abs(a.z[i] - b.z[i])});
  if (made) *made = patches.made();
  ::testing::Test::RecordProperty("worst_nm_" + std::to_string(static_cast<int>(points.x[0])), static_cast<int>(1e9 * out));
  return out;
}

TEST(MapPatch, UtmAtItsMiddleAndItsEdge) {
  EXPECT_LT(worst(core::Crs("EPSG:32632"), survey(47.9, 10.5, 0.1, 100000)), tenth_of_a_millimetre);
  EXPECT_LT(worst(core::Crs("EPSG:32632"), survey(47.9, 6.0, 0.1, 100000)), tenth_of_a_millimetre);
  EXPECT_LT(worst(core::Crs("EPSG:32632"), survey(60.0, 15.0, 0.1, 20000)), tenth_of_a_millimetre);
}

TEST(MapPatch, LambertInFeetAndGeographic) {
  // NAD83(2011) Oregon: heights in metres, easting and northing in international feet.
  EXPECT_LT(worst(core::Crs("EPSG:6557"), survey(44.0, -123.0, 0.1, 100000)), tenth_of_a_millimetre);
  EXPECT_LT(worst(core::Crs("+proj=lcc +lat_1=41 +lat_2=45 +lat_0=43 +lon_0=-120.5 +x_0=400000 +y_0=0 +datum=WGS84 +units=us-ft"),
                  survey(44.0, -123.0, 0.1, 100000)),
            tenth_of_a_millimetre);
  EXPECT_LT(worst(core::Crs("EPSG:4979"), survey(-33.0, 151.0, 0.05, 20000)), tenth_of_a_millimetre);
}

// A grid of undulations in GTX form with steps of one arc minute: slopes change by some 1e-4 from cell to cell.
void write_geoid(const std::filesystem::path& file, double south, double west, int rows, int columns) {
  std::string bytes;
  const auto put = [&](const auto v) {
    char b[sizeof v];
    std::memcpy(b, &v, sizeof v);
    for (size_t i = sizeof v; i-- > 0;) bytes += b[i];  // big endian
  };
  put(south), put(west), put(1.0 / 60.0), put(1.0 / 60.0), put(rows), put(columns);
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < columns; ++j) put(static_cast<float>(45.0 + 0.2 * std::sin(0.9 * i) + 0.2 * std::cos(1.1 * j) + 0.02 * j));
  swath::test::write_bytes(file, bytes);
}

TEST(MapPatch, KinksOfAGeoidAreLeftToProj) {
  const swath::test::TemporaryFolder folder;
  write_geoid(folder / "made.gtx", 47.5, 10.0, 61, 61);
  const core::Crs crs("+proj=utm +zone=32 +datum=WGS84 +units=m +geoidgrids=" + (folder / "made.gtx").string() + " +vunits=m");
  ASSERT_TRUE(crs.has_vertical());
  const Points points = survey(47.9, 10.5, 0.03, 100000);
  MapPatches::Made made;
  EXPECT_LT(worst(crs, points, &made), tenth_of_a_millimetre);
  EXPECT_GT(made.by_proj, 0u);
  EXPECT_GT(made.polynomial, made.by_proj / 2);
}

TEST(MapPatch, ResultsDoNotDependOnBatchesOrThreads) {
  const core::Crs crs("EPSG:32632");
  const Points points = survey(47.9, 10.5, 0.2, 20000);
  const MapPatches one(crs), many(crs);
  Points a = points, b = points;
  one.apply(a.x.data(), a.y.data(), a.z.data(), a.x.size());
  std::vector<std::thread> threads;
  for (size_t k = 0; k < 8; ++k)
    threads.emplace_back([&, k] {
      const size_t from = (7 - k) * 2500;
      many.apply(b.x.data() + from, b.y.data() + from, b.z.data() + from, 2500);
    });
  for (std::thread& t : threads) t.join();
  EXPECT_EQ(a.x, b.x);
  EXPECT_EQ(a.y, b.y);
  EXPECT_EQ(a.z, b.z);
}

TEST(MapPatch, GradientIsTheDifference) {
  const MapPatches patches(core::Crs("EPSG:32632"));
  const Vector3d p = core::ecef_of({47.9 * deg, 10.5 * deg, 600.0});
  const Eigen::Matrix3d J = patches.gradient(p);
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3d h = 5.0 * Vector3d::Unit(axis);
    EXPECT_LT(((patches(p + h) - patches(p - h)) / 10.0 - J.col(axis)).norm(), 1e-8);
  }
  EXPECT_NEAR(J.determinant(), 1.0, 2e-3);  // east, north, up: right-handed, scale of UTM
}

TEST(MapPatch, PointsWithoutAResultAreCounted) {
  const MapPatches patches(core::Crs("EPSG:32632"));
  const Vector3d good = core::ecef_of({47.9 * deg, 10.5 * deg, 600.0});
  const Vector3d antipode = core::ecef_of({0.0, -81.0 * deg, 0.0});  // 90 deg from the central meridian
  std::vector<double> x{good.x(), antipode.x()}, y{good.y(), antipode.y()}, z{good.z(), antipode.z()};
  EXPECT_EQ(patches.apply(x.data(), y.data(), z.data(), 2), 1u);
  EXPECT_TRUE(std::isfinite(x[0]));
  EXPECT_TRUE(std::isnan(x[1]) && std::isnan(y[1]) && std::isnan(z[1]));
}

// Real returns that their maker gives both in ECEF and in UTM 11N, to 1 cm each.
TEST(MapPatch, LeewardPointsMeetTheirMakersUtm) {
  SWATH_SHARED_OR_SKIP(folder, "data/als_leeward");
  const test::Las ecef = test::las(folder / "points_ecef.las"), utm = test::las(folder / "points.las");
  ASSERT_EQ(ecef.records.count(), 1325u);
  Points p;
  for (size_t i = 0; i < ecef.records.count(); ++i)
    p.x.push_back(ecef.coordinate(i, 0)), p.y.push_back(ecef.coordinate(i, 1)), p.z.push_back(ecef.coordinate(i, 2));
  const size_t n = p.x.size();
  const MapPatches patches(core::Crs("EPSG:32611"));
  EXPECT_EQ(patches.apply(p.x.data(), p.y.data(), p.z.data(), n), 0u);
  for (size_t axis = 0; axis < 3; ++axis) {
    const std::vector<double>& ours = axis == 0 ? p.x : axis == 1 ? p.y : p.z;
    double sum = 0.0, squares = 0.0, largest = 0.0;
    for (size_t i = 0; i < n; ++i) {
      const double e = ours[i] - utm.coordinate(i, axis);
      sum += e, squares += e * e, largest = std::max(largest, std::abs(e));
    }
    const double mean = sum / static_cast<double>(n);
    const double deviation = std::sqrt(squares / static_cast<double>(n) - mean * mean);
    EXPECT_LT(std::abs(mean), 2e-4);
    EXPECT_LT(deviation, 3.5e-3);
    EXPECT_LT(largest, 9e-3);
    const std::string name = std::to_string(axis);
    RecordProperty("mean_um_" + name, static_cast<int>(1e6 * mean));
    RecordProperty("std_um_" + name, static_cast<int>(1e6 * deviation));
    RecordProperty("max_um_" + name, static_cast<int>(1e6 * largest));
  }
}

}  // namespace
}  // namespace swath::georef
