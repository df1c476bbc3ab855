// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/corridor/voltage.h"

#include <algorithm>

namespace swath::terrain {

AirGap air_gap(Voltage v) {
  // Highest voltages of the systems: 24, 36, 72.5, 123, 145, 170, 245, 300, 420 and 525 kV.
  constexpr std::array<AirGap, 10> gaps{{{0.22, 0.25},
                                         {0.35, 0.40},
                                         {0.70, 0.80},
                                         {1.00, 1.15},
                                         {1.20, 1.40},
                                         {1.30, 1.50},
                                         {1.70, 2.00},
                                         {2.10, 2.40},
                                         {2.80, 3.20},
                                         {3.50, 4.00}}};
  return gaps[static_cast<size_t>(v)];
}

std::array<double, hazards> clearance_limits(Voltage v) {
  const AirGap gap = air_gap(v);
  return {std::max(6.0, 5.0 + gap.to_earth), 1.5 + gap.to_earth, std::max(5.0, 4.0 + gap.to_earth), gap.between_phases};
}

}  // namespace swath::terrain
