// SPDX-License-Identifier: GPL-3.0-or-later
// A small alphabet for labels in pictures: printable ASCII, each glyph 5 x 8 dots with its baseline under the seventh row.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

namespace swath::report {

constexpr int glyph_width = 5, glyph_height = 8, glyph_baseline = 7;
constexpr int glyph_advance = 6;  ///< from one glyph to the next, dots

/// Rows from the top; bit 4 is the leftmost dot.
using Glyph = std::array<std::uint8_t, glyph_height>;

/// The glyph of a Unicode code point; a hollow box for what the alphabet does not hold.
const Glyph& glyph_of(char32_t code);

/// The code points of UTF-8 text; a damaged byte becomes U+FFFD.
std::vector<char32_t> code_points(std::string_view utf8);

/// Width of a text in dots, without the gap after the last glyph.
int text_dots(std::string_view utf8);

}  // namespace swath::report
