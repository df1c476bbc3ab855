// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/canvas.h"

#include <cmath>

#include "report/font.h"
#include "tests/world/support.h"

namespace swath::report {
namespace {

constexpr core::Rgb black{0, 0, 0};

/// How much ink lies on the picture, in pixels.
double ink(const core::Picture& p) {
  double sum = 0.0;
  for (const std::uint8_t c : p.rgb) sum += (255 - c) / (3.0 * 255.0);
  return sum;
}

TEST(Canvas, ALineCoversLengthTimesWidth) {
  for (const double angle : {0.0, 0.3, 0.7854, 1.2, 2.5})
    for (const double width : {0.5, 1.0, 2.0, 3.5}) {
      core::Picture p(120, 120);
      const double c = 40 * std::cos(angle), s = 40 * std::sin(angle);
      Pen(p, {0, 0, 120, 120}).line({60.2 - c, 60.2 + c}, {60.3 - s, 60.3 + s}, width, black);
      const double ends = 2.0 * width;  // the ends are round and soft
      EXPECT_NEAR(ink(p), 80.0 * width, 0.04 * 80.0 * width + ends) << angle << " " << width;
    }
}

TEST(Canvas, ALineDoesNotDarkenWhereItMeetsItself) {
  core::Picture once(40, 40), twice(40, 40);
  Pen(once, {0, 0, 40, 40}).line({5, 35}, {5, 30}, 1.5, black, 0.5);
  Pen(twice, {0, 0, 40, 40}).line({5, 35, 5, 35}, {5, 30, 5, 30}, 1.5, black, 0.5);
  EXPECT_EQ(once.rgb, twice.rgb);
}

TEST(Canvas, NothingIsDrawnOutsideTheBox) {
  core::Picture p(40, 40);
  Pen pen(p, {10, 10, 20, 20});
  pen.line({-1e9, 1e9}, {20, 20}, 3, black);
  pen.line({5, 5}, {0, 40}, 3, black);
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 40; ++x)
      if (x < 10 || x >= 30 || y < 10 || y >= 30) {
        EXPECT_EQ(*p.at(x, y), 255);
      }
  EXPECT_EQ(*p.at(20, 20), 0);
  mix(p, -1, 5, black, 1.0);
  mix(p, 5, 40, black, 1.0);
}

TEST(Canvas, LevelTextIsTheGlyphsDots) {
  core::Picture p(30, 12);
  EXPECT_EQ(draw_label(p, 2, 3, "E1", 1, black), 11);
  int at = 0;
  for (const char32_t c : {U'E', U'1'}) {
    for (int row = 0; row < glyph_height; ++row)
      for (int dot = 0; dot < glyph_width; ++dot) {
        const bool want = glyph_of(c)[static_cast<size_t>(row)] >> (glyph_width - 1 - dot) & 1;
        EXPECT_EQ(*p.at(2 + at + dot, 3 + row), want ? 0 : 255);
      }
    at += glyph_advance;
  }
}

TEST(Canvas, TurnedTextKeepsItsInkAndItsHaloSurroundsIt) {
  core::Picture level(80, 80), turned(80, 80);
  draw_text(level, 40, 40, "123.5", 2, 0.0, black);
  draw_text(turned, 40, 40, "123.5", 2, 0.6, black);
  EXPECT_NEAR(ink(turned), ink(level), 0.05 * ink(level));
  EXPECT_GT(ink(level), 100.0);
  core::Picture dark(80, 80, {100, 100, 100});
  draw_text(dark, 40, 40, "1", 2, 0.0, black, core::Rgb{255, 255, 255});
  int white = 0;
  for (const std::uint8_t c : dark.rgb) white += c == 255;
  EXPECT_GT(white, 3 * 40);
}

}  // namespace
}  // namespace swath::report
