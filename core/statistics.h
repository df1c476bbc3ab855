// SPDX-License-Identifier: GPL-3.0-or-later
// Order statistics of plain numbers. Measures of accuracy: report/statistics.h.
#pragma once

#include <limits>
#include <vector>

namespace swath::core {

/// The value that floor(share (n - 1)) others lie below; `none` where there are no values. `share` in [0, 1]; values finite.
double quantile(std::vector<double> values, double share, double none = std::numeric_limits<double>::quiet_NaN());

/// Between the two values next to share (n - 1), by a straight line (type 7 of Hyndman and Fan 1996; NumPy's default). Reorders `values`,
/// which are finite and at least one; `share` in [0, 1].
double interpolated_quantile(std::vector<double>& values, double share);

/// The middle value, of an even number the upper of the two; `none` where there are no values. Values finite.
double median(std::vector<double> values, double none = std::numeric_limits<double>::quiet_NaN());

/// Times the median absolute deviation: the standard deviation where errors are normal; 1 / inverse normal distribution at 3/4.
constexpr double mad_to_sigma = 1.4826;

/// Median of the differences of neighbours; 0 for fewer than two.
double median_step(const std::vector<double>& values);

}  // namespace swath::core
