// SPDX-License-Identifier: GPL-3.0-or-later
// Quantiles: of distributions, from Boost.Math, and of samples.
#pragma once

#include <limits>
#include <vector>

namespace swath::core {

/// z with P(Z <= z) = p for the normal distribution; p in (0, 1).
double normal_quantile(double p);

/// x with P(X <= x) = p for chi-square with f > 0 degrees of freedom; p in (0, 1).
double chi_square_quantile(double p, double f);

/// x that chi-square with f > 0 degrees of freedom exceeds with probability q; q in (0, 1), however small.
double chi_square_limit(double q, double f);

/// Between the two values next to share (n - 1), by a straight line (type 7 of Hyndman and Fan 1996; NumPy's default). Reorders `values`,
/// which are finite and at least one; `share` in [0, 1].
double interpolated_quantile(std::vector<double>& values, double share);

/// The median of signed values: of an even number the mean of the two in the middle, so that it changes its sign with them, which
/// core::median() does not; `none` where there are no values. Values finite.
double middle(std::vector<double> values, double none = std::numeric_limits<double>::quiet_NaN());

}  // namespace swath::core
