// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/scan_pattern.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace swath::planning {

double pulse_share(ScanPattern pattern, double half_angle, double from, double to) {
  const auto below = [&](double angle) {
    const double u = std::clamp(angle / half_angle, -1.0, 1.0);
    return pattern == ScanPattern::sine ? 0.5 + std::asin(u) / std::numbers::pi : 0.5 + 0.5 * u;
  };
  return below(to) - below(from);
}

double nadir_share(ScanPattern pattern) { return pattern == ScanPattern::sine ? 2.0 / std::numbers::pi : 1.0; }

double lines_per_second(ScanPattern pattern, double frequency) { return pattern == ScanPattern::polygon ? frequency : 2.0 * frequency; }

double angular_speed(ScanPattern pattern, double half_angle, double frequency) {
  return 2.0 * half_angle * lines_per_second(pattern, frequency);
}

}  // namespace swath::planning
