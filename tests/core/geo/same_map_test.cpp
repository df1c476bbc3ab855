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

TEST(SameMap, CodesHoldWhateverTheText) {
  const Crs utm("EPSG:25832"), written(utm.wkt1());
  EXPECT_TRUE(is_same_map(utm, written));
  EXPECT_TRUE(is_same_crs(utm, written));
  EXPECT_FALSE(is_same_crs(utm, Crs("EPSG:25832+7837")));
}

TEST(SameMap, HeightsAreApartWhereBothAreStated) {
  const Crs unknown("EPSG:25832"), levelled("EPSG:25832+7837"), older("EPSG:25832+5783"), ellipsoidal("EPSG:25832+ellipsoidal");
  EXPECT_FALSE(are_heights_apart(unknown, levelled));
  EXPECT_FALSE(are_heights_apart(levelled, levelled));
  EXPECT_TRUE(are_heights_apart(levelled, older));
  std::string renamed = Crs("EPSG:25832+7837").wkt();
  const std::string name = levelled.vertical_name();
  for (size_t at = renamed.find(name); at != std::string::npos; at = renamed.find(name, at + 4)) renamed.replace(at, name.size(), "DHHN");
  EXPECT_EQ(Crs(renamed).vertical_name(), "DHHN");
  EXPECT_FALSE(are_heights_apart(levelled, Crs(renamed))) << "the code holds whatever the name";
  EXPECT_TRUE(are_heights_apart(levelled, ellipsoidal));
  EXPECT_TRUE(are_comparable(unknown, levelled));
  EXPECT_TRUE(are_comparable(Crs(), levelled));
  EXPECT_FALSE(are_comparable(levelled, older));
  EXPECT_FALSE(are_comparable(unknown, Crs("EPSG:25833")));
}

TEST(SameMap, WithoutCodesTheDefinitionDecides) {
  const Crs plain("+proj=utm +zone=32 +ellps=GRS80 +units=m");
  EXPECT_TRUE(is_same_map(plain, plain));
  EXPECT_FALSE(is_same_map(plain, Crs("+proj=utm +zone=33 +ellps=GRS80 +units=m")));
}

}  // namespace
}  // namespace swath::core
