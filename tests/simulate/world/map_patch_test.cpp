// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulate/world/map_patch.h"

#include <gtest/gtest.h>

#include "core/config/units.h"
#include "core/error.h"
#include "simulate/random.h"

namespace swath::simulate {
namespace {

constexpr double tolerance = 2e-6;  // m: what the class promises
const core::Geodetic origin{48 * core::degree, 10.5 * core::degree, 600.0};

TEST(MapPatch, FollowsTheProjection) {
  const core::Crs crs("EPSG:32632");
  const core::Transform exact(core::wgs84_ecef(), crs);
  for (const double half : {300.0, 3000.0, 9000.0}) {
    const MapPatch map(crs, origin, half, 450, 1500);
    EXPECT_LT(map.worst(), tolerance);
    Random random(9, 9, 9);
    for (int i = 0; i < 300; ++i) {
      const Eigen::Vector3d tangent(random.uniform(-half, half), random.uniform(-half, half), random.uniform(-150, 900));
      const Eigen::Vector3d p = map.ecef_of(tangent);
      EXPECT_LT((map.tangent_of(p) - tangent).norm(), 1e-8);
      EXPECT_LT((map.map_of(tangent) + map.map_origin() - exact(p)).norm(), 2 * tolerance);
    }
  }
}

TEST(MapPatch, ConvergenceOfUtm) {
  const MapPatch map(core::Crs("EPSG:32632"), origin, 500, 500, 700);
  // First term of the series: (longitude - central meridian) sin(latitude); grid north lies east of true north east of the meridian.
  EXPECT_NEAR(map.convergence(), 1.5 * core::degree * std::sin(48 * core::degree), 1e-5);
}

TEST(MapPatch, RefusesCrsThatAreNoMap) {
  EXPECT_THROW(MapPatch(core::Crs("EPSG:4979"), origin, 500, 500, 700), core::Error);
  EXPECT_THROW(MapPatch(core::Crs("EPSG:2263"), origin, 500, 500, 700), core::Error);
  EXPECT_THROW(MapPatch(core::Crs("EPSG:2048"), origin, 500, 500, 700), core::Error);  // westing, southing: its north is south
}

}  // namespace
}  // namespace swath::simulate
