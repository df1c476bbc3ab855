// SPDX-License-Identifier: GPL-3.0-or-later
// Distributions as counts of narrow bins, so that a survey of any size passes through and tiles can be joined.
#pragma once

#include <cstdint>
#include <map>

#include "core/config/result.h"

namespace swath::quality {

/// Counts by bin; bin k holds values from (k - 1/2) to (k + 1/2) widths.
using Bins = std::map<std::int32_t, double>;

/// The bin of a value; beyond a million bins the outermost.
std::int32_t bin_of(double value, double width);

/// The value that a share of the counted lies below, linear within a bin; NaN where nothing is counted.
double bin_quantile(const Bins& bins, double share, double width);

/// The same of the distances from `middle`.
Bins distances_from(const Bins& bins, double middle, double width);

/// Sums of errors; plain data.
struct ErrorSums {
  std::uint64_t n = 0;
  double sum = 0.0, squares = 0.0;
  void add(double error) { ++n, sum += error, squares += error * error; }
  void add(const ErrorSums& s) { n += s.n, sum += s.sum, squares += s.squares; }
};

/// Measures of accuracy by Hohle and Hohle (2009), key Hohle2009, of errors in m; quantiles to half a bin. NaN where nothing is counted.
struct BinnedStatistics {
  std::uint64_t n = 0;
  double mean = 0.0, std = 0.0, rms = 0.0, median = 0.0, nmad = 0.0, q68 = 0.0, q90 = 0.0, q95 = 0.0;
};

template <class V>
void describe(const BinnedStatistics& r, V& v) {
  using core::metres;
  v.result("n", r.n, "Differences.");
  v.result("mean_m", r.mean, metres(3), "Mean.");
  v.result("std_m", r.std, metres(3), "Standard deviation about the mean.");
  v.result("rms_m", r.rms, metres(3).in_summary(), "Root mean square.");
  v.result("median_m", r.median, metres(3), "Median.");
  v.result("nmad_m", r.nmad, metres(3), "1.4826 times the median distance from the median.");
  v.result("q68_m", r.q68, metres(3), "68.3 % of the absolute values are smaller.");
  v.result("q90_m", r.q90, metres(3), "90 % of the absolute values are smaller.");
  v.result("q95_m", r.q95, metres(3), "95 % of the absolute values are smaller.");
}

BinnedStatistics statistics_of(const ErrorSums& sums, const Bins& bins, double width);

}  // namespace swath::quality
