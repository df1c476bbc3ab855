// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/ties/cross_sections.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/geo/geodesy.h"

namespace swath::calib {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// A block at the central meridian of UTM 32, where east on the map is east in the local frame to 1e-3.
TieSet block_of(const std::vector<TiePlane>& planes, int lines) {
  TieSet t;
  t.frame = trajectory::local_frame(core::ecef_of({0.83, 9 * core::degree, 500.0}));
  t.planes = planes;
  for (std::uint32_t k = 0; k < planes.size(); ++k)
    for (int l = 0; l < lines; ++l) t.groups.push_back({k, static_cast<std::uint32_t>(l), 0, 0});
  return t;
}

TiePlane roof(const Vector3d& centre, const Vector3d& normal) {
  TiePlane p;
  p.centre = centre;
  p.normal = normal.normalized();
  p.half = {12, 4};
  p.kind = TieKind::roof;
  return p;
}

TEST(CrossSections, TargetFirstThenTheSteepestDownTheirSlope) {
  TiePlane target = roof({0, 0, 0}, {0, 0, 1});
  target.kind = TieKind::target;
  target.name = "hangar";
  TiePlane ground = roof({300, 0, 0}, {0, 0, 1});
  ground.kind = TieKind::ground;
  const TieSet ties =
      block_of({roof({100, 0, 0}, {0.2, 0, 1}), target, roof({200, 0, 0}, {0, 0.5, 1}), roof({215, 0, 0}, {0, -0.5, 1}), ground}, 3);
  const MapPatches map(core::Crs("EPSG:32632"));
  const auto plans = plan_sections(ties, map, 1.0, 5);
  ASSERT_EQ(plans.size(), 3u) << "the other side of the steep roof is too near, ground is none";
  EXPECT_EQ(plans[0].name, "hangar");
  EXPECT_EQ(plans[1].name, "roof 3");
  EXPECT_EQ(plans[2].name, "roof 1");
  constexpr double scale = 0.03;  // m: the map's scale over some 30 m
  const Vector2d along_hangar = plans[0].ends[1] - plans[0].ends[0], down_steep = plans[1].ends[1] - plans[1].ends[0];
  EXPECT_NEAR(std::abs(along_hangar.x()), 2 * (12 + 10), scale);
  EXPECT_NEAR(along_hangar.y(), 0, scale);
  EXPECT_NEAR(down_steep.x(), 0, scale);
  EXPECT_NEAR(std::abs(down_steep.y()), 2 * (4 + 10) / std::sqrt(1.25), scale);
  EXPECT_EQ(plan_sections(ties, map, 1.0, 1).size(), 1u);
}

TEST(CrossSections, ReturnsWithinTheCutAlone) {
  SectionPlan plan;
  plan.ends = {Vector2d(1000, 2000), Vector2d(1030, 2040)};  // 50 m
  plan.width = 2.0;
  SectionReturns returns({plan});
  const Vector2d along(0.6, 0.8), across(-0.8, 0.6);
  core::Block b;
  b.origin = {900, 1900, 100};
  const auto add = [&](double s, double q, double z) {
    const Vector2d p = plan.ends[0] + s * along + q * across;
    b.x.push_back(p.x() - 900);
    b.y.push_back(p.y() - 1900);
    b.z.push_back(z - 100);
  };
  add(10, 0.9, 512);
  add(10, 1.1, 513);  // beside
  add(-1, 0, 514);    // before
  add(50.5, 0, 515);  // behind
  add(49, -0.9, 516);
  returns.add(4, b);
  returns.add(5, core::Block{});
  ASSERT_EQ(returns.of(0).size(), 1u);
  const auto& of_line = returns.of(0).at(4);
  ASSERT_EQ(of_line.along.size(), 2u);
  EXPECT_NEAR(of_line.along[0], 10, 1e-9);
  EXPECT_NEAR(of_line.height[0], 512, 1e-9);
  EXPECT_NEAR(of_line.along[1], 49, 1e-9);
}

}  // namespace
}  // namespace swath::calib
