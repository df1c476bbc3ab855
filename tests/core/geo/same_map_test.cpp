// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/geo/same_map.h"

#include <gtest/gtest.h>

namespace swath::core {
namespace {

TEST(SameMap, HeightsAreLeftOut) {
  const Crs utm("EPSG:25832");
  for (const char* same : {"EPSG:25832", "EPSG:25832+7837", "EPSG:25832+ellipsoidal"}) {
    EXPECT_TRUE(is_same_map(utm, Crs(same))) << same;
    EXPECT_TRUE(is_same_map(Crs(same), utm)) << same;
  }
  EXPECT_FALSE(is_same_map(utm, Crs("EPSG:25833")));
  EXPECT_FALSE(is_same_map(utm, Crs("EPSG:32632")));  // another datum
}

TEST(SameMap, WithoutCodesTheDefinitionDecides) {
  const Crs plain("+proj=utm +zone=32 +ellps=GRS80 +units=m");
  EXPECT_TRUE(is_same_map(plain, plain));
  EXPECT_FALSE(is_same_map(plain, Crs("+proj=utm +zone=33 +ellps=GRS80 +units=m")));
}

}  // namespace
}  // namespace swath::core
