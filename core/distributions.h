// SPDX-License-Identifier: GPL-3.0-or-later
// Quantiles of distributions, from Boost.Math.
#pragma once

namespace swath::core {

/// z with P(Z <= z) = p for the normal distribution; p in (0, 1).
double normal_quantile(double p);

/// x with P(X <= x) = p for chi-square with f > 0 degrees of freedom; p in (0, 1).
double chi_square_quantile(double p, double f);

/// x that chi-square with f > 0 degrees of freedom exceeds with probability q; q in (0, 1), however small.
double chi_square_limit(double q, double f);

}  // namespace swath::core
