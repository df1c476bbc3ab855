// SPDX-License-Identifier: GPL-3.0-or-later
// How a scanner spreads its pulses over the field of view.
#pragma once

#include <array>
#include <string_view>

#include "core/config/option.h"

namespace swath::planning {

enum class ScanPattern {
  triangle,  ///< oscillating mirror of constant angular speed
  sine,      ///< oscillating mirror that swings: dense at the edges
  polygon,   ///< one-way scan of constant angular speed
};

/// Share of the pulses between scan angles `from` and `to` (rad, from <= to) of a field of view of +-`half_angle`.
double pulse_share(ScanPattern pattern, double half_angle, double from, double to);

/// Pulses per rad at the nadir as a share of those of an even spread: 1, or 2/pi for a sine, which is densest at its edges.
double nadir_share(ScanPattern pattern);

/// Scan lines per second where `frequency` counts full scans: there and back are two lines of a mirror, a facet is one.
double lines_per_second(ScanPattern pattern, double frequency);

/// Mean angular speed of the beam, rad/s.
double angular_speed(ScanPattern pattern, double half_angle, double frequency);

}  // namespace swath::planning

namespace swath::core {
template <>
struct Choices<planning::ScanPattern> {
  static constexpr std::array<std::string_view, 3> names{"triangle", "sine", "polygon"};
};
}  // namespace swath::core
