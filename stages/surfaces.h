// SPDX-License-Identifier: GPL-3.0-or-later
// The one list of products that are grids: what the raster writer writes of them.
#pragma once

#include <string_view>
#include <vector>

#include "stages/stage.h"

namespace swath::stages {

struct Surface {
  Product product;
  std::string_view band;  ///< description of its band
  std::string_view unit;  ///< empty: none; "height": the CRS's unit of heights, in which values, sigmas are written
  bool has_quality;       ///< sigma, count and void reason are written beside it
};

const std::vector<Surface>& surfaces();

}  // namespace swath::stages
