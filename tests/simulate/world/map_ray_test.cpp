// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulate/world/map_ray.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/config/units.h"

namespace swath::simulate {
namespace {

using Eigen::Vector3d;

TEST(MapRay, IsTheLineOnTheMapToAMicrometre) {
  WorldOptions w;
  w.scene = Scene::hills;
  const Relief relief(w, 3, core::degrees(0.0), 2000.0);
  const core::Geodetic origin{48 * core::degree, 10.5 * core::degree, 600.0};
  const MapPatch map(core::Crs("EPSG:32632"), origin, 2000.0, relief.lowest() - 20.0, 1700.0);
  const Vector3d tangent(150, -220, 1000), slope = Vector3d(0.4, 0.3, -0.8).normalized();
  const auto found = ray_down(map, relief, tangent, slope);
  ASSERT_TRUE(found);
  for (const double share : {0.0, 0.3, 0.7, 1.0}) {
    const double s = share * found->length;
    EXPECT_LT((found->ray.at(s) - map.map_of(tangent + (found->begin + s) * slope)).norm(), 1e-6);
  }
  EXPECT_GT(found->ray.at(0.0).z(), relief.highest());
  EXPECT_LT(found->ray.at(found->length).z(), relief.lowest());
  EXPECT_FALSE(ray_down(map, relief, tangent, Vector3d(1.0, 0.0, -0.05).normalized()));
}

}  // namespace
}  // namespace swath::simulate
