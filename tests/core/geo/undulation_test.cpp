// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/geo/undulation.h"

#include <gtest/gtest.h>

#include <cmath>

namespace swath::core {
namespace {

TEST(Undulation, OfEgm96AtPublishedPlaces) {
  const double found = undulation({-90.220845, 38.628155});
  if (std::isnan(found)) GTEST_SKIP() << "the grid egm96_15.gtx is not installed";
  // NGA's test points of EGM96; the grid of 15 minutes is within 0.1 m of the model there.
  EXPECT_NEAR(found, -31.628, 0.2);
  EXPECT_NEAR(undulation({-54.978886, -14.621217}), -2.969, 0.2);
}

}  // namespace
}  // namespace swath::core
