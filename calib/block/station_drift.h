// SPDX-License-Identifier: GPL-3.0-or-later
// Stations against a reference, strip by strip: the differences as they are, less their mean, less a straight line in time (Ackermann,
// the Flevoland block). What the line takes away is what unknown shifts and drifts of a block adjustment absorb.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/config/result.h"

namespace swath::calib {

/// Differences station less reference of one coordinate, one strip.
struct StripDifferences {
  std::string strip;
  std::vector<double> time;        ///< s
  std::vector<double> difference;  ///< any one unit
};

struct DriftLine {
  std::string strip;
  size_t stations = 0;
  double a0 = 0.0, a1 = 0.0;  ///< line a0 + a1 t, t as given; per second
  double direct = 0.0;        ///< root mean square of the differences
  double less_mean = 0.0;     ///< of what is left when the mean is taken off
  double less_line = 0.0;     ///< of what is left when the line is
};

template <class V>
void describe(const DriftLine& r, V& v) {
  v.result("strip", r.strip, "Strip.");
  v.result("stations", r.stations, "Stations.");
  v.result("rms_direct", r.direct, core::plain(4), "Root mean square of the differences, in their unit.");
  v.result("rms_less_mean", r.less_mean, core::plain(4), "Root mean square when the mean is taken off.");
  v.result("rms_less_line", r.less_line, core::plain(4), "Root mean square when a straight line in time is taken off.");
  v.result("shift", r.a0, core::plain(4), "Value of the line at time 0.");
  v.result("drift_per_s", r.a1, core::plain(6), "Change of the line per second.");
}

struct DriftFound {
  std::string coordinate;
  DriftLine together;  ///< one line through all strips; less_mean: each strip's own mean
  std::vector<DriftLine> strips;
  double less_lines = 0.0;  ///< root mean square when each strip's own line is taken off
};

template <class V>
void describe(const DriftFound& r, V& v) {
  v.result("coordinate", r.coordinate, "Column of the differences.");
  v.result("stations", r.together.stations, "Stations.");
  v.result("rms_direct", r.together.direct, core::plain(4).in_summary(), "Root mean square of all differences, in their unit.");
  v.result("rms_less_strip_means", r.together.less_mean, core::plain(4).in_summary(), "Root mean square, each strip's mean taken off.");
  v.result("rms_less_one_line", r.together.less_line, core::plain(4).in_summary(), "Root mean square, one line in time taken off.");
  v.result("rms_less_strip_lines", r.less_lines, core::plain(4).in_summary(), "Root mean square, each strip's line taken off.");
  v.result("shift", r.together.a0, core::plain(4), "Value of the one line at time 0.");
  v.result("drift_per_s", r.together.a1, core::plain(6), "Change of the one line per second.");
  v.tables("strips", r.strips, "Strip by strip.");
}

/// A line needs two instants; a strip at one instant has its mean as its line.
DriftFound drift_of(const std::string& coordinate, const std::vector<StripDifferences>& strips);

}  // namespace swath::calib
