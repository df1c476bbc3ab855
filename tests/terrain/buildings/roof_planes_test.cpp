// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/buildings/roof_planes.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/terrain/buildings/made_roofs.h"

namespace swath::terrain {
namespace {

struct Found {
  Tin tin;
  RoofPlanes roof;
};

Found planes_of(const test::Roof& roof, double density, double sigma, const RoofPlaneOptions& o = {}) {
  core::Block b;
  std::vector<std::uint32_t> rows;
  for (const RoofReturn& r : test::returns_of(roof, 40.0, density, sigma, 5)) {
    b.x.push_back(r.x), b.y.push_back(r.y), b.z.push_back(r.z);
    rows.push_back(static_cast<std::uint32_t>(rows.size()));
  }
  Found out{triangulate(b, rows, 1.0), {}};
  TrianglePart all(out.tin.size());
  for (size_t t = 0; t < all.size(); ++t) all[t] = static_cast<std::int32_t>(t);
  out.roof = roof_planes(out.tin, all, o);
  return out;
}

TEST(RoofPlanes, AGableHasTwoWithSlopeAspectAndNoise) {
  // The ridge runs 0.3 rad north of east; the southern side falls to south-south-east.
  const Found f = planes_of(test::gable(20, 20, 0.3, 12, 6, 4.0, 7.0), 8.0, 0.03);
  ASSERT_EQ(f.roof.planes.size(), 2u);
  for (const RoofPlane& p : f.roof.planes) {
    EXPECT_NEAR(p.inclination(), std::atan(0.5), 0.01);
    const double south = M_PI - 0.3, north = 2 * M_PI - 0.3;
    EXPECT_LT(std::min(std::abs(p.aspect() - south), std::abs(p.aspect() - north)), 0.02);
    EXPECT_NEAR(p.rms, 0.03 * std::cos(std::atan(0.5)), 0.005);
    EXPECT_NEAR(p.area, 144.0, 10.0);
  }
  EXPECT_NEAR(std::abs(f.roof.planes[0].aspect() - f.roof.planes[1].aspect()), M_PI, 0.03);
}

TEST(RoofPlanes, ALevelRoofHasNoAspectAndAStepMakesTwo) {
  const Found flat = planes_of([](double x, double y) { return x < 20 && y < 15 ? 9.0 : test::off_roof; }, 4.0, 0.02);
  ASSERT_EQ(flat.roof.planes.size(), 1u);
  EXPECT_TRUE(std::isnan(flat.roof.planes[0].aspect()));
  EXPECT_NEAR(flat.roof.planes[0].height({10, 7}), 9.0, 0.01);
  const Found step = planes_of([](double x, double y) { return x < 20 && y < 15 ? (x < 8 ? 9.0 : 9.6) : test::off_roof; }, 4.0, 0.02);
  ASSERT_EQ(step.roof.planes.size(), 2u);
  EXPECT_NEAR(step.roof.planes[0].level - step.roof.planes[1].level, 0.6, 0.02);
}

TEST(RoofPlanes, SmallOnesAndRoughSurfacesAreNone) {
  RoofPlaneOptions o;
  o.least_area = 30.0;
  const Found dormer =
      planes_of([](double x, double y) { return x < 20 && y < 15 ? (x < 3 && y < 3 ? 11.0 : 9.0) : test::off_roof; }, 8.0, 0.02, o);
  EXPECT_EQ(dormer.roof.planes.size(), 1u);
  const Found crown = planes_of([](double x, double y) { return 9.0 + std::sin(17 * x) * std::cos(13 * y); }, 8.0, 0.3);
  EXPECT_EQ(crown.roof.planes.size(), 0u);
}

}  // namespace
}  // namespace swath::terrain
