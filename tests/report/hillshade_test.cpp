// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/hillshade.h"

#include <cmath>

#include "core/option_visitors.h"
#include "tests/world/support.h"

namespace swath::report {
namespace {

constexpr double float_tolerance = 2e-6;  // brightness is a float between 0 and 1, heights are floats of some 100 m

/// A plane that rises so much per run to the east and to the north.
std::vector<float> plane(const core::Lattice& l, double east, double north) {
  std::vector<float> z(l.size());
  for (int j = 0; j < l.ny; ++j)
    for (int i = 0; i < l.nx; ++i) z[l.at(i, j)] = static_cast<float>(l.cell * (east * i + north * j));
  return z;
}

TEST(Hillshade, APlaneIsLitByLambertsLaw) {
  const core::Lattice l{2.0, 0, 0, 9, 7};
  HillshadeOptions o;
  o.multidirectional = false;
  const size_t inside = l.at(4, 3);
  EXPECT_NEAR(hillshade(l, plane(l, 0, 0), o)[inside], std::sin(core::pi / 4), float_tolerance);
  // Normal (0.5, -0.5, 1)/sqrt(1.5), light (-1/2, 1/2, 1/sqrt 2): a slope falling to the north-west faces the light.
  EXPECT_NEAR(hillshade(l, plane(l, 0.5, -0.5), o)[inside], (0.5 + std::sqrt(0.5)) / std::sqrt(1.5), float_tolerance);
  EXPECT_NEAR(hillshade(l, plane(l, -0.5, 0.5), o)[inside], (std::sqrt(0.5) - 0.5) / std::sqrt(1.5), float_tolerance);
  EXPECT_EQ(hillshade(l, plane(l, -3, 3), o)[inside], 0.0f);  // in its own shadow
  o.exaggeration = 2.0;
  EXPECT_NEAR(hillshade(l, plane(l, 0.25, -0.25), o)[inside], (0.5 + std::sqrt(0.5)) / std::sqrt(1.5), float_tolerance);
}

TEST(Hillshade, FourLightsLeaveNoSlopeDark) {
  const core::Lattice l{1.0, 0, 0, 5, 5};
  EXPECT_NEAR(hillshade(l, plane(l, 0, 0))[12], std::sin(core::pi / 4), float_tolerance);
  // Falling to the south-east, away from 315: the light at 225 grazes it and counts fully, that at 315 not at all.
  EXPECT_GT(hillshade(l, plane(l, -1, 1))[12], 0.2f);
  // Falling to the west with slope 1; weights sin^2 of 45, 0, 45, 90 deg times cosines.
  const double c = std::sqrt(0.5), n = std::sqrt(2.0);
  const double side = (c + c * c) / n, north = c / n;
  EXPECT_NEAR(hillshade(l, plane(l, 1, 0))[12], (0.5 * side + 0.5 * side + north) / 2.0, float_tolerance);
}

TEST(Hillshade, VoidsStayVoidAndDoNotSpread) {
  const core::Lattice l{1.0, 0, 0, 5, 5};
  std::vector<float> z = plane(l, 0, 0);
  z[12] = std::numeric_limits<float>::quiet_NaN();
  const auto shade = hillshade(l, z);
  for (size_t k = 0; k < shade.size(); ++k) {
    if (k == 12)
      EXPECT_TRUE(std::isnan(shade[k]));
    else
      EXPECT_NEAR(shade[k], std::sin(core::pi / 4), float_tolerance);
  }
}

}  // namespace
}  // namespace swath::report
