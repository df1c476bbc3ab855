// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/las_crs.h"

#include <cstring>

#include "tests/io/las_sample.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

LasVlr keys(std::initializer_list<std::array<std::uint16_t, 4>> list) {
  LasVlr v{"LASF_Projection", 34735, "", {}, 0, 0};
  v.data.resize(8 * (list.size() + 1));
  const std::array<std::uint16_t, 4> head{1, 1, 0, static_cast<std::uint16_t>(list.size())};
  std::memcpy(v.data.data(), head.data(), 8);
  std::size_t at = 8;
  for (const auto& key : list) std::memcpy(&v.data[at], key.data(), 8), at += 8;
  return v;
}

TEST(LasCrs, FromKeysAndWkt) {
  LasHeader h;
  EXPECT_EQ(las_crs(h).definition, "");
  h.vlrs = {keys({{{1024, 0, 1, 1}}, {{3072, 0, 1, 26910}}})};
  EXPECT_EQ(las_crs(h).definition, "EPSG:26910");
  h.vlrs = {keys({{{2048, 0, 1, 4269}}, {{3072, 0, 1, 2994}}, {{4096, 0, 1, 5703}}, {{4099, 0, 1, 9002}}})};
  EXPECT_EQ(las_crs(h).definition, "EPSG:2994+5703");
  EXPECT_DOUBLE_EQ(las_crs(h).vertical_metres, 0.3048);
  h.vlrs = {keys({{{2048, 0, 1, 4326}}, {{4096, 0, 1, 3855}}})};
  EXPECT_EQ(las_crs(h).definition, "EPSG:4326+3855");
  h.vlrs = {keys({{{3072, 0, 1, 32632}}, {{4096, 0, 1, 5030}}})};
  EXPECT_EQ(las_crs(h).definition, "EPSG:32632");
  EXPECT_FALSE(las_crs(h).note.empty());
  h.vlrs = {keys({{{1024, 0, 1, 3}}, {{2048, 0, 1, 4326}}})};
  EXPECT_EQ(las_crs(h).definition, "EPSG:4978");
  h.vlrs = {keys({{{1024, 0, 1, 3}}, {{2048, 0, 1, 4269}}})};
  EXPECT_EQ(las_crs(h).definition, "");
  h.vlrs = {keys({{{3072, 0, 1, 32767}}})};
  EXPECT_EQ(las_crs(h).definition, "");
  EXPECT_NE(las_crs(h).note.find("without EPSG code"), std::string::npos);
  add_las_wkt(h, "PROJCS[\"x\"]");
  EXPECT_EQ(las_crs(h).definition, "PROJCS[\"x\"]");
  EXPECT_TRUE(h.global_encoding & las_encoding::wkt);
}

TEST(LasCrs, KeysThatLieAboutTheirNumberAreReadAsFarAsTheyGo) {
  LasHeader h;
  LasVlr v = keys({{{3072, 0, 1, 32632}}});
  v.data[6] = 200;
  h.vlrs = {v};
  EXPECT_EQ(las_crs(h).definition, "EPSG:32632");
}

TEST(LasCrs, OfTheReferenceFiles) {
  SWATH_SHARED_OR_SKIP(data, "data/isprs");
  EXPECT_EQ(LasReader(data / "samp11-utm.laz").crs().definition, "EPSG:32632");
  EXPECT_DOUBLE_EQ(LasReader(data / "samp11-utm.laz").crs().vertical_metres, 1.0);
  EXPECT_EQ(LasReader(data.parent_path() / "autzen/autzen_trim.las").crs().definition.substr(0, 6), "PROJCS");
  EXPECT_EQ(LasReader(data.parent_path() / "als_leeward/points_ecef.las").crs().definition, "EPSG:4978");
}

}  // namespace
}  // namespace swath::io
