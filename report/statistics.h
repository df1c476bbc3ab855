// SPDX-License-Identifier: GPL-3.0-or-later
// Statistics of errors: of a vector, or of a stream too long to keep.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "core/config/result.h"

namespace swath::report {

/// Measures of accuracy for errors in one unit; NaN where n is too small. Robust ones after Höhle and Höhle (2009), "Accuracy assessment
/// of digital elevation models by means of robust statistical methods", table 2.
struct Statistics {
  std::uint64_t n = 0;        ///< finite errors
  std::uint64_t skipped = 0;  ///< NaN or infinite, in no measure
  double mean = std::numeric_limits<double>::quiet_NaN();
  double std = mean;  ///< about the mean, n - 1
  double rms = mean;  ///< about zero
  double median = mean;
  double nmad = mean;  ///< 1.4826 median |e - median|: the standard deviation where errors are normal
  double q68 = mean;   ///< quantile 0.683 of |e|
  double q95 = mean;   ///< quantile 0.95 of |e|
  double minimum = mean, maximum = mean;
  double max_abs = mean;
  /// Bin of the histogram that median, nmad and quantiles come from; 0 = exact. Within the histogram's reach the median and the quantiles
  /// lie within one bin of the order statistic, nmad within three; beyond it they are the extreme on their side.
  double resolution = 0.0;
};

/// Measures that do not exist are left out.
template <class V>
void describe(const Statistics& r, V& v) {
  v.result("n", r.n, "Errors.");
  v.result("skipped", r.skipped, core::if_any(), "Errors that are not finite, in no measure.");
  v.result("mean", r.mean, "Mean.");
  v.result("std", r.std, "Standard deviation about the mean.");
  v.result("rms", r.rms, "Root mean square.");
  v.result("median", r.median, "Median.");
  v.result("nmad", r.nmad, "1.4826 times the median distance from the median.");
  v.result("q68", r.q68, "68.3 % of the sizes lie below.");
  v.result("q95", r.q95, "95 % of the sizes lie below.");
  v.result("minimum", r.minimum, "Smallest value.");
  v.result("maximum", r.maximum, "Largest value.");
  v.result("max_abs", r.max_abs, "Largest size.");
  v.result("resolution", r.resolution, core::if_any(), "Bin of the histogram that the quantiles come from; exact without.");
}

/// Exact statistics. Quantiles interpolate linearly between order statistics (type 7 of Hyndman and Fan 1996).
Statistics statistics(std::vector<double> errors);

/// Statistics of a stream in constant memory: mean and deviation by Welford's recurrence (merging: Chan, Golub, LeVeque 1983), quantiles
/// from a histogram of bins of width `bin` over [-reach, reach]. Counts, extremes and histogram do not depend on the order of values or
/// merges; mean and deviations do by rounding only (some 1e-15 of the largest value), so merge in a fixed order.
class StreamingStatistics {
 public:
  /// `bin` and `reach` in the errors' unit; throws Error where they are not positive or make over 10 million bins.
  explicit StreamingStatistics(double bin = 0.001, double reach = 10.0);
  void add(double error);
  /// Throws Error where the other has different bins.
  void merge(const StreamingStatistics& other);
  Statistics result() const;

 private:
  double quantile(double p) const;                    // of e
  double quantile_abs(double p, double about) const;  // of |e - about|
  double bin_, reach_;
  std::vector<std::uint64_t> counts_;  // first and last bins hold what is beyond reach
  std::uint64_t n_ = 0, skipped_ = 0;
  double mean_ = 0.0, m2_ = 0.0, minimum_, maximum_;
};

}  // namespace swath::report
