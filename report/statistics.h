// SPDX-License-Identifier: GPL-3.0-or-later
// Statistics of errors.
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
  v.result("q68", r.q68, "68.3 % of the absolute values are smaller.");
  v.result("q95", r.q95, "95 % of the absolute values are smaller.");
  v.result("minimum", r.minimum, "Smallest value.");
  v.result("maximum", r.maximum, "Largest value.");
  v.result("max_abs", r.max_abs, "Largest absolute value.");
}

/// Quantiles interpolate linearly between order statistics (type 7 of Hyndman and Fan 1996).
Statistics statistics(std::vector<double> errors);

}  // namespace swath::report
