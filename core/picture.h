// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace swath::core {

/// One colour, sRGB, 8 bits each.
using Rgb = std::array<std::uint8_t, 3>;

/// An sRGB picture, 8 bits per channel; row-major from the top left, three bytes per pixel.
struct Picture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;  ///< 3 * width * height

  explicit Picture(int w = 0, int h = 0, Rgb fill = {255, 255, 255}) : width(w), height(h) {
    rgb.reserve(3 * static_cast<size_t>(w) * static_cast<size_t>(h));
    for (size_t n = static_cast<size_t>(w) * static_cast<size_t>(h); n > 0; --n) rgb.insert(rgb.end(), fill.begin(), fill.end());
  }
  bool holds(int x, int y) const { return x >= 0 && y >= 0 && x < width && y < height; }
  std::uint8_t* at(int x, int y) { return &rgb[3 * (static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x))]; }
  const std::uint8_t* at(int x, int y) const {
    return &rgb[3 * (static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x))];
  }
};

}  // namespace swath::core
