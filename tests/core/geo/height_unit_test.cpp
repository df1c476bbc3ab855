// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/geo/height_unit.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

namespace swath::core {
namespace {

TEST(HeightUnit, IsStatedBesideACrsThatLeavesItOpen) {
  constexpr double survey_foot = 1200.0 / 3937.0;
  const std::vector<std::pair<double, std::string>> units{
      {1.0, "metre"}, {0.3048, "foot"}, {survey_foot, "US survey foot"}, {0.5, "height unit"}};
  for (const auto& [metres, name] : units) {
    const Crs crs(with_height_unit(Crs("EPSG:2263"), metres, ellipsoidal_heights));
    EXPECT_NEAR(crs.vertical_metres_per_unit(), metres, 1e-14);
    EXPECT_EQ(crs.vertical_unit_name(), name);
    EXPECT_TRUE(crs.has_height_unit());
    EXPECT_EQ(crs.heights(), Heights::unknown);
    EXPECT_EQ(crs.epsg(), 2263);
    EXPECT_NE(crs.name().find("+ ellipsoidal height"), std::string::npos) << crs.name();
  }
}

TEST(HeightUnit, IsKnownByItsNamesInFiles) {
  EXPECT_EQ(metres_of_unit_name("metre"), 1.0);
  EXPECT_EQ(metres_of_unit_name("ft"), 0.3048);
  for (const char* name : {"US survey foot", "ftUS", "us-ft", "US-ft", "ft_us", "usft"})
    EXPECT_EQ(metres_of_unit_name(name), 1200.0 / 3937.0) << name;
  EXPECT_EQ(metres_of_unit_name("cm"), 0.01);
  EXPECT_FALSE(metres_of_unit_name("unknown") || metres_of_unit_name(""));
}

TEST(HeightUnit, HasASymbolThatIsReadAgain) {
  for (const double metres : {1.0, 0.3048, 1200.0 / 3937.0, 0.201168}) EXPECT_EQ(metres_of_unit_name(unit_symbol(metres)), metres);
  EXPECT_EQ(unit_symbol(0.201168), "units of 0.201168 m");
}

TEST(HeightUnit, TheTwoFeetAreTwoUnits) {
  EXPECT_FALSE(is_same_unit(0.3048, 1200.0 / 3937.0));
  EXPECT_TRUE(is_same_unit(0.304800609601, 1200.0 / 3937.0));
}

}  // namespace
}  // namespace swath::core
