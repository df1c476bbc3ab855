// SPDX-License-Identifier: GPL-3.0-or-later
// Values of an image between the centres of its pixels, bilinear.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "io/raster/image_raster.h"

namespace swath::calib {

/// The four pixels around a place and their weights.
class PixelBlend {
 public:
  /// Pixels from the corner of the first one, y down; outside the centres of the outermost pixels as at these. The image must outlive this.
  PixelBlend(const io::ImageRaster& image, double x, double y) {
    const double u = std::clamp(x - 0.5, 0.0, image.columns - 1.0), w = std::clamp(y - 0.5, 0.0, image.rows - 1.0);
    const int left = static_cast<int>(u), above = static_cast<int>(w);
    const int right = std::min(left + 1, image.columns - 1), below = std::min(above + 1, image.rows - 1);
    a_ = u - left, b_ = w - above;
    at_[0] = &image.values[image.at(left, above)], at_[1] = &image.values[image.at(right, above)];
    at_[2] = &image.values[image.at(left, below)], at_[3] = &image.values[image.at(right, below)];
  }
  double of(std::size_t band) const {
    return (1 - b_) * ((1 - a_) * at_[0][band] + a_ * at_[1][band]) + b_ * ((1 - a_) * at_[2][band] + a_ * at_[3][band]);
  }

 private:
  const std::uint16_t* at_[4];
  double a_ = 0.0, b_ = 0.0;
};

}  // namespace swath::calib
