// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/adjust/parameter_words.h"

#include <array>

#include "calib/report_units.h"
#include "core/config/units.h"

namespace swath::calib {

const ParameterWords& words_of(Parameter parameter) {
  static constexpr std::array<ParameterWords, latency + 1> words{{
      {"boresight_roll", "boresight roll", "rad", "arcsec", arc_second},
      {"boresight_pitch", "boresight pitch", "rad", "arcsec", arc_second},
      {"boresight_heading", "boresight heading", "rad", "arcsec", arc_second},
      {"lever_forward", "lever arm forward", "m", "mm", 1e-3},
      {"lever_right", "lever arm right", "m", "mm", 1e-3},
      {"lever_down", "lever arm down", "m", "mm", 1e-3},
      {"range_offset", "range offset", "m", "mm", 1e-3},
      {"range_scale", "range scale", "1", "ppm", 1e-6},
      {"scan_offset", "scan offset", "rad", "arcsec", arc_second},
      {"scan_scale", "scan scale", "1", "ppm", 1e-6},
      {"latency", "latency", "s", "ms", 1e-3},
  }};
  return words.at(static_cast<size_t>(parameter));
}

}  // namespace swath::calib
