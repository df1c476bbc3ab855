// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/block_frame.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"

namespace swath::calib {
namespace {

using Eigen::Vector3d;

// m: PROJ inverts the seven parameters between the datums by their signs, which leaves 0.12 mm.
constexpr double datum = 2e-4;

TEST(BlockFrame, ThereAndBackAndLocal) {
  const BlockFrame frame("EPSG:25832+ellipsoidal", {600000, 5600000, 300});
  for (const Vector3d& p : {Vector3d(600000, 5600000, 300), Vector3d(604000, 5597000, 1500)})
    EXPECT_LT((frame.map_of(frame.local_of(p)) - p).norm(), datum);
  EXPECT_LT(frame.local_of({600000, 5600000, 300}).norm(), 1e-6);
  // 100 m up is 100 m; 1000 m of grid is 1000 m over the scale of the projection, 0.99972 there with the height's share.
  EXPECT_NEAR(frame.local_of({600000, 5600000, 400}).z(), 100.0, 1e-6);
  EXPECT_NEAR(frame.local_of({600000, 5601000, 300}).norm(), 1000.0, 0.5);
  const BlockFrame local("local", {1, 2, 3});
  EXPECT_TRUE(local.is_local());
  EXPECT_EQ(local.local_of({5, 6, 7}), Vector3d(5, 6, 7));
}

TEST(BlockFrame, GridNorthIsTurnedByTheConvergence) {
  // Meridian convergence of a transverse Mercator projection: (longitude - central) sin(latitude), to 1e-6 rad near the central meridian.
  const Vector3d at(600000, 5600000, 300);
  const BlockFrame frame("EPSG:25832+ellipsoidal", at);
  const core::Transform to_geodetic(core::Crs("EPSG:25832+ellipsoidal"), core::wgs84_geodetic());
  const Vector3d g = to_geodetic(at) * M_PI / 180.0;
  const double convergence = std::atan(std::tan(g.x() - 9.0 * M_PI / 180.0) * std::sin(g.y()));
  const Vector3d grid_north = frame.local_R_grid(Vector3d::Zero()).col(1);  // in east, north, up: the frame's own
  EXPECT_NEAR(std::atan2(grid_north.x(), grid_north.y()), convergence, 2e-6);
  // A grid step to the north goes along it.
  const Vector3d step = frame.local_of(at + Vector3d(0, 10, 0)) - frame.local_of(at);
  EXPECT_NEAR(std::atan2(step.x(), step.y()), convergence, 2e-6);
  EXPECT_NEAR(grid_north.z(), 0.0, 1e-12);
}

TEST(BlockFrame, AnglesCountFromANorthingAxis) {
  // A map of southing and westing is a mirror image: no rotation turns it to the ground.
  EXPECT_THROW(BlockFrame("EPSG:5513+ellipsoidal", {1117832, 674238, 300}), core::Error);
  EXPECT_NO_THROW(BlockFrame("EPSG:5514+ellipsoidal", {-674238, -1117832, 300}));
}

}  // namespace
}  // namespace swath::calib
