// SPDX-License-Identifier: GPL-3.0-or-later
// The calibration parameters in files and in words.
#pragma once

#include <string_view>

#include "calib/terms.h"
#include "georef/shot_geometry.h"

namespace swath::calib {

struct ParameterWords {
  std::string_view key;         ///< in files: "boresight_roll"
  std::string_view name;        ///< "boresight roll"
  std::string_view unit;        ///< SI, of files: "m", "rad", "s", "1"
  std::string_view sigma_unit;  ///< of sigmas in reports: "arcsec", "mm", "ppm", "ms"
  double sigma_size;            ///< SI value of one sigma_unit
};

/// Of boresight_roll to latency; throws std::out_of_range for the others.
const ParameterWords& words_of(Parameter parameter);

}  // namespace swath::calib
