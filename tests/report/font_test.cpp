// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/font.h"

#include <set>

#include "tests/world/support.h"

namespace swath::report {
namespace {

TEST(Font, EveryPrintableCharacterHasAGlyphOfItsOwn) {
  std::set<Glyph> seen;
  for (char32_t c = U' '; c <= U'~'; ++c) EXPECT_TRUE(seen.insert(glyph_of(c)).second) << static_cast<int>(c);
  EXPECT_TRUE(seen.insert(glyph_of(U'ä')).second);
  EXPECT_EQ(glyph_of(U'ä'), glyph_of(U'\n'));
}

TEST(Font, RowsRunFromTheTopAndBitsFromTheLeft) {
  EXPECT_EQ(glyph_of(U'L'), (Glyph{16, 16, 16, 16, 16, 16, 31, 0}));
  EXPECT_EQ(glyph_of(U'p')[7], 16);  // below the baseline
}

TEST(Font, Utf8IsCountedByCodePoints) {
  EXPECT_EQ(code_points("aé€😀"), (std::vector<char32_t>{U'a', U'é', U'€', U'😀'}));
  EXPECT_EQ(code_points("a\xFF"), (std::vector<char32_t>{U'a', 0xFFFD}));
  EXPECT_EQ(code_points("\xE2\x82"), (std::vector<char32_t>{0xFFFD}));
  EXPECT_EQ(text_dots(""), 0);
  EXPECT_EQ(text_dots("ab"), 11);
  EXPECT_EQ(text_dots("é"), 5);
}

}  // namespace
}  // namespace swath::report
