// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/vector/city_json.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/error.h"
#include "io/text/value_file.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

using core::Value;

const std::vector<Eigen::Vector3d> square{{500000.1234, 10, 5}, {500010.1234, 10, 5}, {500010.1234, 20, 5}, {500000.1234, 20, 5}};

CityObject hall() {
  CityObject out;
  out.id = "building-1";
  out.attributes = {
      {"area", 100.0}, {"planes", std::int64_t{1}}, {"note", std::string("a \"b\"")}, {"eaves", std::numeric_limits<double>::quiet_NaN()}};
  out.geometries = {{"0", false, {{"GroundSurface", {square}}}},
                    {"1", true, {{"RoofSurface", {square}}, {"WallSurface", {square}}, {"", {square}}}}};
  return out;
}

Value written(const std::vector<CityObject>& objects, const std::string& crs) {
  const test::TemporaryFolder folder;
  write_city_json(folder / "a.city.json", objects, crs, "halls");
  return read_value_file(folder / "a.city.json");
}

const Value& in(const Value& v, const std::string& key) {
  const Value* found = v.find(key);
  if (!found) throw core::Error("no member", key);
  return *found;
}

TEST(CityJson, HasTheMembersOfTheStandard) {
  const Value v = written({hall()}, "EPSG:25832+7837");
  EXPECT_EQ(in(v, "type").as_text(), "CityJSON");
  EXPECT_EQ(in(v, "version").as_text(), "2.0");
  EXPECT_EQ(in(in(v, "metadata"), "referenceSystem").as_text(), "https://www.opengis.net/def/crs/EPSG/0/25832");
  EXPECT_EQ(in(written({}, "EPSG:7415"), "metadata").find("referenceSystem")->as_text(), "https://www.opengis.net/def/crs/EPSG/0/7415");
  EXPECT_EQ(in(written({hall()}, ""), "metadata").find("referenceSystem"), nullptr);
  EXPECT_EQ(in(in(v, "metadata"), "geographicalExtent").items().size(), 6u);
  const Value& object = in(in(v, "CityObjects"), "building-1");
  EXPECT_EQ(in(object, "type").as_text(), "Building");
  EXPECT_EQ(in(in(object, "attributes"), "note").as_text(), "a \"b\"");
  EXPECT_EQ(in(object, "attributes").find("eaves"), nullptr);  // not a number
}

TEST(CityJson, VerticesAreWholeNumbersOnceEach) {
  const Value v = written({hall()}, "EPSG:25832");
  ASSERT_EQ(in(v, "vertices").items().size(), 4u);
  const Value& transform = in(v, "transform");
  const auto real = [&](size_t vertex, size_t k) {
    return static_cast<double>(in(v, "vertices").items()[vertex].items()[k].as_int()) * in(transform, "scale").items()[k].as_number() +
           in(transform, "translate").items()[k].as_number();
  };
  for (size_t k = 0; k < 3; ++k) EXPECT_NEAR(real(0, k), square[0](static_cast<int>(k)), 0.0005 + 1e-9);
}

TEST(CityJson, SolidsHaveAShellAndSemanticsAsDeepAsTheirSurfaces) {
  const Value v = written({hall()}, "EPSG:25832");
  const auto& geometry = in(in(in(v, "CityObjects"), "building-1"), "geometry").items();
  ASSERT_EQ(geometry.size(), 2u);
  EXPECT_EQ(in(geometry[0], "type").as_text(), "MultiSurface");
  EXPECT_EQ(in(geometry[0], "lod").as_text(), "0");
  EXPECT_EQ(in(geometry[0], "boundaries").items()[0].items()[0].items().size(), 4u);  // surface, ring, vertices
  EXPECT_EQ(in(geometry[1], "type").as_text(), "Solid");
  EXPECT_EQ(in(geometry[1], "boundaries").items()[0].items()[0].items()[0].items().size(), 4u);  // shell before them
  const Value& values = in(in(geometry[1], "semantics"), "values").items()[0];
  EXPECT_EQ(values.items()[1].as_int(), 1);
  EXPECT_TRUE(values.items()[2].is_null());
}

TEST(CityJson, WithoutObjectsItIsTheSmallestFile) {
  const Value v = written({}, "EPSG:25832");
  EXPECT_TRUE(in(v, "vertices").items().empty());
  EXPECT_EQ(in(v, "metadata").find("geographicalExtent"), nullptr);
}

TEST(CityJson, SidesThatVanishAreLeftOutOfAllFaces) {
  CityObject o = hall();
  o.geometries = {
      {"0",
       false,
       {{"", {{{0, 0, 0}, {0.0001, 0, 0}, {9, 0, 0}, {9, 9, 0}}}}, {"", {{{0, 0, 0}, {0.0001, 0, 0}, {0.0001, 0, 5}, {0, 0, 5}}}}}}};
  const Value v = written({o}, "EPSG:25832");
  const auto& surfaces = in(in(in(in(v, "CityObjects"), "building-1"), "geometry").items()[0], "boundaries").items();
  ASSERT_EQ(surfaces.size(), 1u);  // the wall between two vertices that are one is gone
  EXPECT_EQ(surfaces[0].items()[0].items().size(), 3u);
}

TEST(CityJson, OneIdTwiceAndPlacesThatAreNoneAreRefused) {
  const test::TemporaryFolder folder;
  EXPECT_THROW(write_city_json(folder / "a.city.json", {hall(), hall()}, "", ""), core::Error);
  CityObject o = hall();
  o.geometries[0].surfaces[0].rings[0][1].z() = std::nan("");
  EXPECT_THROW(write_city_json(folder / "a.city.json", {o}, "", ""), core::Error);
  EXPECT_EQ(test::entries(folder.path()), 0u);
}

}  // namespace
}  // namespace swath::io
