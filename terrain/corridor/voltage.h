// SPDX-License-Identifier: GPL-3.0-or-later
// Distances that wires must keep, by the line's voltage.
#pragma once

#include <array>
#include <string_view>

#include "core/config/option.h"
#include "terrain/corridor/obstacles.h"

namespace swath::terrain {

/// Nominal voltage of a line.
enum class Voltage { kv20, kv30, kv66, kv110, kv132, kv150, kv220, kv275, kv380, kv500 };

/// Air gaps that prevent a flashover, m, for the highest voltage of the system: to earth, and between phases (EN 50341-1).
struct AirGap {
  double to_earth, between_phases;
};
AirGap air_gap(Voltage v);

/// m, by Hazard, after EN 50341-1 for normal ground, trees that may be climbed, roofs that are not steep, and other wires: 5 m (at least 6
/// in all), 1.5 m, 4 m (at least 5 in all) and the gap alone. National annexes differ.
std::array<double, hazards> clearance_limits(Voltage v);

}  // namespace swath::terrain

template <>
struct swath::core::Choices<swath::terrain::Voltage> {
  static constexpr std::array<std::string_view, 10> names{"20 kV",  "30 kV",  "66 kV",  "110 kV", "132 kV",
                                                          "150 kV", "220 kV", "275 kV", "380 kV", "500 kV"};
};
