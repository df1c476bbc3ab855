// SPDX-License-Identifier: GPL-3.0-or-later
#include "quality/cover_words.h"

#include <gtest/gtest.h>

namespace swath::quality {
namespace {

const std::vector<std::string> usual{"", "open", "bare", "urban", "NVA"};

TEST(CoverWords, OpenGroundInSixLanguages) {
  for (const char* word : {"open", "Open Terrain", "bare-earth", "offen", "Bebaut", "Straße", "sol nu", "SOL_NU", "bâti", "abierto",
                           "suelo desnudo", "aperto", "suolo nudo", "onbegroeid", "verhard", "short grass", "nva", ""})
    EXPECT_TRUE(is_open_cover(word, usual)) << word;
}

TEST(CoverWords, VegetationInSixLanguages) {
  for (const char* word : {"forest", "Wald", "Gebüsch", "GEBÜSCH", "Wiese", "forêt", "hautes herbes", "broussailles", "bosque", "matorral",
                           "hierba", "bosco", "cespugli", "erba", "bos", "struiken", "hoog gras", "VVA", "tall grass"}) {
    EXPECT_FALSE(is_open_cover(word, usual)) << word;
    EXPECT_NE(cover_in_english(word), "") << word;
  }
}

TEST(CoverWords, UnknownOnesAreNeither) {
  for (const char* word : {"", "x17", "op", "bare|urban", "|", "offen?", "\xc3"}) EXPECT_EQ(cover_in_english(word), "") << word;
}

TEST(CoverWords, TheListOfOpenCoversDecides) {
  EXPECT_FALSE(is_open_cover("bebaut", {"open"})) << "urban is not in the list";
  EXPECT_TRUE(is_open_cover("X17", {"x17"}));
  EXPECT_TRUE(is_open_cover("offen", {"Open"}));
  EXPECT_TRUE(is_open_cover("wald", {"forest"}));
  EXPECT_FALSE(is_open_cover("", {"open"}));
}

}  // namespace
}  // namespace swath::quality
