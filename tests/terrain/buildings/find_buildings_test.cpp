// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/buildings/find_buildings.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "terrain/buildings/roof_solid.h"
#include "tests/terrain/buildings/made_roofs.h"

namespace swath::terrain {
namespace {

using Eigen::Vector2d;

test::Roof flat(double x0, double y0, double x1, double y1, double z) {
  return [=](double x, double y) { return x > x0 && x < x1 && y > y0 && y < y1 ? z : test::off_roof; };
}

FoundBuildings found_in(const test::Roof& roof, double side, double density, unsigned seed = 3, const BuildingOptions& o = {}) {
  return find_buildings(test::returns_of(roof, side, density, 0.02, seed), test::open_ground(), o);
}

TEST(Buildings, AFlatHallHasItsAreaItsCornersAndOnePlane) {
  const FoundBuildings f = found_in(flat(5, 8, 35, 28, 9.0), 40.0, 6.0);
  ASSERT_EQ(f.buildings.size(), 1u);
  const Building& b = f.buildings[0];
  EXPECT_TRUE(b.squared);
  EXPECT_FALSE(b.is_cut);
  ASSERT_EQ(b.outline.outer.size(), 4u);
  EXPECT_NEAR(b.area, 600.0, 10.0);
  for (const Vector2d& p : b.outline.outer) {
    EXPECT_LT(std::min(std::abs(p.x() - 5), std::abs(p.x() - 35)), 0.2);
    EXPECT_LT(std::min(std::abs(p.y() - 8), std::abs(p.y() - 28)), 0.2);
  }
  ASSERT_EQ(b.planes.size(), 1u);
  EXPECT_GT(b.explained, 0.98);
  EXPECT_NEAR(b.eaves, 9.0, 0.02);
  EXPECT_NEAR(b.ridge, 9.0, 0.02);
  EXPECT_NEAR(b.middle, 9.0, 0.02);
  EXPECT_EQ(b.lowest_ground, 0.0);
}

TEST(Buildings, AGableReachesEavesAndRidgeBeyondItsReturns) {
  const FoundBuildings f = found_in(test::gable(20, 20, 0.4, 9, 5, 4.0, 7.5), 40.0, 5.0);
  ASSERT_EQ(f.buildings.size(), 1u);
  const Building& b = f.buildings[0];
  EXPECT_NEAR(b.area, 180.0, 6.0);
  EXPECT_EQ(b.planes.size(), 2u);
  EXPECT_NEAR(b.ridge, 7.5, 0.05);
  EXPECT_NEAR(b.eaves, 4.0, 0.12);
  EXPECT_NEAR(b.middle, 5.75, 0.2);
  EXPECT_GT(b.on_lowest, 0.99);
  EXPECT_NEAR(volume(roof_solid(b, 0.0)), 180 * 4.0 + 180 * 3.5 / 2, 40.0);
  ASSERT_EQ(b.faces.size(), 2u);
  for (const RoofFace& face : b.faces) {
    EXPECT_NEAR(face.outline.area(), 90.0, 12.0);
    int on_ridge = 0;
    for (const Vector2d& p : face.outline.outer) on_ridge += std::abs(b.planes[face.plane].height(p) - 7.5) < 0.05;
    EXPECT_GE(on_ridge, 2);
  }
}

TEST(Buildings, NoiseDoesNotRaiseTheRidge) {
  double sum = 0.0;
  for (unsigned seed = 1; seed <= 5; ++seed)
    sum += find_buildings(test::returns_of(test::gable(20, 20, 0.4, 9, 5, 4.0, 7.5), 40.0, 8.0, 0.04, seed), test::open_ground(), {})
               .buildings.at(0)
               .ridge;
  EXPECT_NEAR(sum / 5, 7.5, 0.02);
}

TEST(Buildings, AnLShapeKeepsItsCourtyardAndASmallHoleIsFilled) {
  const auto roof = [](double x, double y) {
    const bool in = x > 5 && x < 45 && y > 5 && y < 45 && !(x > 30 && y > 30);
    const bool yard = x > 12 && x < 22 && y > 12 && y<20, light = x> 35 && x < 37 && y > 15 && y < 17;
    return in && !yard && !light ? 8.0 : test::off_roof;
  };
  const FoundBuildings f = found_in(roof, 50.0, 6.0);
  ASSERT_EQ(f.buildings.size(), 1u);
  const Building& b = f.buildings[0];
  EXPECT_TRUE(b.squared);
  EXPECT_EQ(b.outline.outer.size(), 6u);
  ASSERT_EQ(b.outline.holes.size(), 1u);
  EXPECT_EQ(b.outline.holes[0].size(), 4u);
  EXPECT_NEAR(b.area, 1600 - 225 - 80, 20.0);
}

TEST(Buildings, TwoHousesWithAGapAreTwoAndAnnexesAreOne) {
  const auto two = [](double x, double y) { return y > 5 && y < 15 && x > 5 && x < 35 && !(x > 18 && x < 21) ? 6.0 : test::off_roof; };
  EXPECT_EQ(found_in(two, 40.0, 8.0).buildings.size(), 2u);
  BuildingOptions o;
  o.gap = 5.0;
  EXPECT_EQ(found_in(two, 40.0, 8.0, 3, o).buildings.size(), 1u);
  const auto annexe = [](double x, double y) { return y > 5 && y < 15 && x > 5 && x < 35 ? (x < 20 ? 6.0 : 3.0) : test::off_roof; };
  const FoundBuildings f = found_in(annexe, 40.0, 8.0);
  ASSERT_EQ(f.buildings.size(), 1u);
  EXPECT_EQ(f.buildings[0].planes.size(), 2u);
  EXPECT_LT(f.buildings[0].on_lowest, 0.6);  // two levels are no roof of lowest planes
  EXPECT_NEAR(f.buildings[0].eaves, 3.0, 0.02);
  EXPECT_NEAR(f.buildings[0].ridge, 6.0, 0.02);
}

TEST(Buildings, ASlopeGivesLowestAndMeanGround) {
  Surroundings3d slope = test::open_ground();
  slope.ground = [](const Vector2d& p) { return 0.2 * p.x(); };
  const FoundBuildings f = find_buildings(test::returns_of(flat(10, 10, 30, 20, 12.0), 40.0, 6.0, 0.02, 4), slope, {});
  ASSERT_EQ(f.buildings.size(), 1u);
  EXPECT_NEAR(f.buildings[0].lowest_ground, 0.2 * 9.0, 0.1);
  EXPECT_NEAR(f.buildings[0].mean_ground, 0.2 * 20.0, 0.1);
  slope.ground = [](const Vector2d&) { return Building::none; };
  EXPECT_TRUE(
      std::isnan(find_buildings(test::returns_of(flat(10, 10, 30, 20, 12.0), 40.0, 6.0, 0.02, 4), slope, {}).buildings[0].lowest_ground));
}

TEST(Buildings, OneAtTheRimOfTheDataIsFlagged) {
  Surroundings3d rim = test::open_ground();
  rim.has_returns = [](const Vector2d& p) { return p.x() < 30.0; };
  const auto returns = test::returns_of(flat(20, 10, 30, 20, 5.0), 40.0, 6.0, 0.02, 4);
  EXPECT_TRUE(find_buildings(returns, rim, {}).buildings[0].is_cut);
  rim.has_returns = [](const Vector2d& p) { return p.x() < 30.0 || p.x() > 37.0; };  // 7 m: a shadow of the roof, 5 m high
  EXPECT_FALSE(find_buildings(returns, rim, {}).buildings[0].is_cut);
  rim.has_returns = [](const Vector2d& p) { return p.x() < 30.0 || p.x() > 42.0; };  // none is as long as 12 m
  EXPECT_TRUE(find_buildings(returns, rim, {}).buildings[0].is_cut);
}

TEST(Buildings, NothingOneReturnAndNumbersThatAreNoneGiveNoBuilding) {
  EXPECT_TRUE(find_buildings({}, test::open_ground(), {}).buildings.empty());
  const FoundBuildings one = find_buildings({{1, 2, 3}}, test::open_ground(), {});
  EXPECT_TRUE(one.buildings.empty());
  EXPECT_EQ(one.alone, 1u);
  const FoundBuildings line = find_buildings({{1, 1, 3}, {2, 2, 3}, {3, 3, 3}, {1, 1, 4}}, test::open_ground(), {});
  EXPECT_TRUE(line.buildings.empty());
  const FoundBuildings shed = found_in(flat(5, 5, 8, 8, 2.5), 20.0, 8.0);
  EXPECT_TRUE(shed.buildings.empty());
  EXPECT_EQ(shed.small, 1u);
  std::vector<RoofReturn> hall = test::returns_of(flat(5, 8, 35, 28, 9.0), 40.0, 6.0, 0.02, 3);
  hall.push_back({Building::none, 10.0, 9.0});
  hall.push_back({10.0, 10.0, Building::none});
  const FoundBuildings f = find_buildings(hall, test::open_ground(), {});
  EXPECT_EQ(f.not_finite, 2u);
  ASSERT_EQ(f.buildings.size(), 1u);
  EXPECT_NEAR(f.buildings[0].area, 600.0, 10.0);
}

TEST(Buildings, TheOrderOfTheReturnsChangesNothing) {
  std::vector<RoofReturn> returns = test::returns_of(test::gable(20, 20, 0.4, 9, 5, 4.0, 7.5), 40.0, 5.0, 0.03, 8);
  const Building a = find_buildings(returns, test::open_ground(), {}).buildings.at(0);
  std::reverse(returns.begin(), returns.end());
  const Building b = find_buildings(returns, test::open_ground(), {}).buildings.at(0);
  EXPECT_EQ(a.outline.outer, b.outline.outer);
  EXPECT_EQ(a.ridge, b.ridge);
  EXPECT_EQ(a.eaves, b.eaves);
  ASSERT_EQ(a.faces.size(), b.faces.size());
  for (size_t k = 0; k < a.faces.size(); ++k) EXPECT_EQ(a.faces[k].outline.outer, b.faces[k].outline.outer);
}

}  // namespace
}  // namespace swath::terrain
