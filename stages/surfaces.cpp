// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/surfaces.h"

namespace swath::stages {

const std::vector<Surface>& surfaces() {
  static const std::vector<Surface> list = {
      {Product::dtm, "height", "height", true},
      {Product::dsm, "height", "height", true},
      {Product::canopy, "height above ground", "height", false},
      {Product::slope, "slope", "degree", false},
      {Product::hillshade, "hillshade", "", false},
      {Product::intensity, "intensity", "", false},
      {Product::pulse_density, "pulses per square metre", "1/m2", false},
      {Product::return_density, "returns per square metre", "1/m2", false},
  };
  return list;
}

}  // namespace swath::stages
