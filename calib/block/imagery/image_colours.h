// SPDX-License-Identifier: GPL-3.0-or-later
// Colours of places on photographs: of each photograph the window that they lie in is read, once.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "calib/block/imagery/oriented_images.h"

namespace swath::calib {

inline constexpr std::uint32_t no_image = 0xffffffffu;

/// A place on a photograph: pixels from the corner of the first one, y down.
struct ImagePlace {
  std::uint32_t image = no_image;
  float x = 0.0f, y = 0.0f;
  float side = 0.0f;  ///< of the square whose mean is taken, pixels; up to 1: bilinear
};

/// Red, green, blue over 16 bits: values of 8 bits times 256, as LAS has it (LAS 1.4 R15, table 4); of one band all three are the same.
using Colour = std::array<std::uint16_t, 3>;

/// Black where the place is on no image. Throws core::Error where a photograph cannot be read.
std::vector<Colour> colours_of(const OrientedImages& images, const std::vector<ImagePlace>& places);

}  // namespace swath::calib
