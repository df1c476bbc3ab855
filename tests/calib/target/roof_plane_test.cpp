// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/target/roof_plane.h"

#include <gtest/gtest.h>

namespace swath::calib {
namespace {

using Eigen::Vector2d;

RoofMotion flight_to(double heading) {
  RoofMotion m;
  m.x = {std::sin(heading), std::cos(heading)};
  m.y = {m.x.y(), -m.x.x()};
  return m;
}

// Pulses every metre on a roof of 40 m x 20 m that is displaced and tilted, and one in seven far above it.
struct Roof {
  RoofTarget target;
  std::vector<Pierced> pulses;
  std::vector<Beamline> beams;

  Roof(const RoofMotion& m, double height, const Vector2d& tilt) {
    target.corners = {{20, 10}, {-20, 10}, {-20, -10}, {20, -10}};
    for (double x = -19.5; x < 20.0; x += 1.0)
      for (double y = -9.5; y < 10.0; y += 1.0) {
        const Vector2d at(x, y);
        const double above = beams.size() % 7 == 0 ? 0.45 : height + tilt.x() * m.x.dot(at) + tilt.y() * m.y.dot(at);
        pulses.push_back({at + m.at(at), {0, 0}, above, above, beams.size()});
        beams.emplace_back();
      }
  }
};

TEST(RoofPlane, HeightAndTiltsInTheAxesOfTheFlight) {
  RoofMotion m = flight_to(0.7);
  m.value[RoofMotion::along] = 0.8;
  m.value[RoofMotion::across] = -0.4;
  const Roof roof(m, 0.12, {2e-3, -1e-3});
  const RoofPlane found = fit_roof_plane(roof.pulses, roof.beams, roof.target, m, 0.01);
  EXPECT_NEAR(found.value[0], 0.12, 1e-6);
  EXPECT_NEAR(found.value[1], 2e-3, 1e-6);
  EXPECT_NEAR(found.value[2], -1e-3, 1e-6);
  EXPECT_LT(found.rms, 1e-6);
  const Eigen::Vector3d plane = found.as_plane(m);
  EXPECT_NEAR(plane[0] + plane.tail<2>().dot(Vector2d(m.x)), 0.122, 1e-6) << "a metre along the flight";
}

TEST(RoofPlane, TooFewReturnsMakeNone) {
  const RoofMotion m = flight_to(0.0);
  Roof roof(m, 0.0, {0, 0});
  roof.pulses.resize(9);
  EXPECT_EQ(fit_roof_plane(roof.pulses, roof.beams, roof.target, m, 0.01).n, 0u);
}

TEST(RoofMotionTest, ADisplacementIsItsNormalsSum) {
  RoofMotion m = flight_to(1.1);
  m.centre = {3, -2};
  m.value << 0.5, -0.3, 0.01, -0.02, 0.004, 0.003, 0.0;
  const Vector2d p(12, 7), n = Vector2d(0.6, 0.8);
  EXPECT_NEAR(m.along_normal(p, n).dot(m.value), m.at(p).dot(n), 1e-12);
  EXPECT_NEAR(m.slope_normal({0, 1}, n).dot(m.value), (m.at(p + Vector2d(0, 1)) - m.at(p)).dot(n), 1e-12);
}

}  // namespace
}  // namespace swath::calib
