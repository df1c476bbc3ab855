// SPDX-License-Identifier: GPL-3.0-or-later
// What is left of the groups of returns after an adjustment, by line, scan angle, range and time; and of overlapping lines.
#pragma once

#include <cstdint>
#include <vector>

#include "calib/adjust/adjustment.h"
#include "calib/report/report_data.h"
#include "calib/ties/tie_set.h"
#include "report/statistics.h"

namespace swath::calib {

enum class BinBy {
  line,   ///< TieLine::id
  angle,  ///< mean scan angle, deg
  range,  ///< mean range, m
  time,   ///< mean time since the first line's first return, s
};

/// Groups of returns whose value lies in [low, high); by line: low = high = id. Groups taken out by data snooping are counted and in
/// none of the measures. Those are NaN where no group is left.
struct ResidualBin {
  double low = 0.0, high = 0.0;
  std::uint64_t groups = 0, rejected = 0, returns = 0;  ///< used, taken out; returns of those used
  double mean_before = 0.0, rms_before = 0.0;           ///< of the groups' mean distances from their planes, m
  double mean_after = 0.0, rms_after = 0.0;             ///< m
  double rms_returns = 0.0;                             ///< of all returns about the adjusted planes, m
  double largest_w = 0.0;                               ///< largest size of a standardised residual
};

/// Bins without any group are left out. Steps are 1, 2 or 5 times a power of ten, at most ten bins.
std::vector<ResidualBin> residual_bins(const calib::Adjustment& adjustment, const calib::TieSet& ties, BinBy by);
/// All groups together.
ResidualBin residual_total(const calib::Adjustment& adjustment);

/// The value of one group that BinBy speaks of.
double bin_value(const calib::GroupResidual& group, const calib::TieSet& ties, BinBy by);

/// Time that `BinBy::time` counts from: the first return of all lines, GPS time, s.
double first_time(const calib::TieSet& ties);

/// Of the cells of a difference grid that have a value, m.
report::Statistics difference_statistics(const core::Grid& difference);

/// Tie planes that both lines see (ids).
std::uint64_t common_planes(const calib::TieSet& ties, int line_a, int line_b);
/// Tie planes that a line sees.
std::uint64_t planes_of(const calib::TieSet& ties, int line);

}  // namespace swath::calib
