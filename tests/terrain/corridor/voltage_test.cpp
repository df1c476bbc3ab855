// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/corridor/voltage.h"

#include <gtest/gtest.h>

namespace swath::terrain {
namespace {

TEST(Voltage, LimitsGrowWithIt) {
  for (int k = 1; k < 10; ++k) {
    const AirGap low = air_gap(static_cast<Voltage>(k - 1)), high = air_gap(static_cast<Voltage>(k));
    EXPECT_GT(high.to_earth, low.to_earth);
    EXPECT_GT(high.between_phases, high.to_earth);
    for (size_t kind = 0; kind < hazards; ++kind)
      EXPECT_GE(clearance_limits(static_cast<Voltage>(k))[kind], clearance_limits(static_cast<Voltage>(k - 1))[kind]);
  }
}

TEST(Voltage, OfALineOf380Kilovolt) {
  const auto limits = clearance_limits(Voltage::kv380);
  EXPECT_NEAR(limits[0], 7.8, 1e-12);
  EXPECT_NEAR(limits[1], 4.3, 1e-12);
  EXPECT_NEAR(limits[2], 6.8, 1e-12);
  EXPECT_NEAR(limits[3], 3.2, 1e-12);
  EXPECT_EQ(clearance_limits(Voltage::kv20)[0], 6.0);  // never less
}

}  // namespace
}  // namespace swath::terrain
