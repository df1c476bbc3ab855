// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/raster/impossible_heights.h"

#include <gtest/gtest.h>

#include <cmath>

namespace swath::io {
namespace {

TEST(ImpossibleHeights, FeetAndMetres) {
  const HeightRule feet(0.3048, std::nullopt), metres(1.0, std::nullopt);
  for (const double none : {-9999.0, -32767.0, -32768.0, -99999.0, 7e4, 1e31})
    EXPECT_TRUE(feet.is_impossible(none) && metres.is_impossible(none)) << none;
  for (const double height : {9999.0, 29029.0}) EXPECT_TRUE(!feet.is_impossible(height) && metres.is_impossible(height)) << height;
  EXPECT_FALSE(metres.is_impossible(8848) || metres.is_impossible(-10900) || metres.is_impossible(std::nan("")));
}

TEST(ImpossibleHeights, WhereTheFileDeclaresAValueTheRangeAloneCounts) {
  EXPECT_FALSE(HeightRule(1.0, -32767.0).is_impossible(-9999));
  EXPECT_TRUE(HeightRule(1.0, -9999.0).is_impossible(-32767));
  EXPECT_TRUE(HeightRule(1.0, std::nan("")).is_impossible(-9999)) << "NaN declares nothing of numbers";
}

TEST(ImpossibleHeights, TheirSentence) {
  ImpossibleHeights found;
  found.add(-9999);
  EXPECT_EQ(sentence_of(found, "in/a.tif"),
            "a.tif: 1 height of -9999, which no ground has, is taken as void; declare the value: gdal_edit.py -a_nodata -9999 a.tif, or "
            "the unit of the heights");
  found.add({2, 48000, 50000});
  EXPECT_EQ(sentence_of(found, "in/a.tif"),
            "a.tif: 3 heights between -9999 and 50000, which no ground has, are taken as void; declare its value for none (gdal_edit.py "
            "-a_nodata), or the unit of the heights");
}

TEST(ImpossibleHeights, TheBandsUnitOrThatOfTheCrs) {
  EXPECT_EQ(metres_per_height("ft", "EPSG:32632"), 0.3048);
  EXPECT_NEAR(metres_per_height("", "EPSG:2263+6360"), 1200.0 / 3937.0, 1e-12);
  EXPECT_EQ(metres_per_height("", ""), 1.0);
}

}  // namespace
}  // namespace swath::io
