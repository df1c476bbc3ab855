// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/expected_time.h"

#include <gtest/gtest.h>

#include "stages/registry.h"

namespace swath::pipeline {
namespace {

using stages::Grain;

TEST(ExpectedTime, EveryStageThatWorksOnReturnsHasOne) {
  size_t longer = 0, whole = 0, records = 0;
  for (const auto& e : stages::registry()) {
    const auto stage = e.make();
    for (const Grain g : stage->info().grains) {
      const double s = expected_seconds(e.name, g);
      if (g == Grain::survey) {
        EXPECT_GE(s, 0.0) << e.name;
        whole += s > 0.0;
        records += expected_seconds_of_imu_record(e.name) > 0.0;
      } else {
        EXPECT_GT(s, 0.0) << e.name;
      }
      longer += g == Grain::tile && s != expected_seconds("any other", g);
    }
  }
  EXPECT_EQ(longer, 17u) << "a name of the list is not a stage";
  EXPECT_EQ(whole, 3u) << "a name of the list is not a stage";
  EXPECT_EQ(records, 2u) << "a name of the list is not a stage";
  EXPECT_GT(expected_seconds("filters.ground", Grain::tile), expected_seconds("filters.noise", Grain::tile));
}

}  // namespace
}  // namespace swath::pipeline
