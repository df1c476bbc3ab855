// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/distributions.h"

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/normal.hpp>

#include <algorithm>
#include <cstddef>

namespace swath::core {

namespace math = boost::math;

double normal_quantile(double p) { return math::quantile(math::normal(), p); }

double chi_square_quantile(double p, double f) { return math::quantile(math::chi_squared(f), p); }

double chi_square_limit(double q, double f) { return math::quantile(math::complement(math::chi_squared(f), q)); }

double interpolated_quantile(std::vector<double>& values, double share) {
  const double at = share * static_cast<double>(values.size() - 1);
  const auto number = static_cast<std::ptrdiff_t>(at);
  std::nth_element(values.begin(), values.begin() + number, values.end());
  const double low = values[static_cast<size_t>(number)];
  if (number + 1 == static_cast<std::ptrdiff_t>(values.size())) return low;
  const double high = *std::min_element(values.begin() + number + 1, values.end());
  return low + (at - static_cast<double>(number)) * (high - low);
}

double middle(std::vector<double> values, double none) { return values.empty() ? none : interpolated_quantile(values, 0.5); }

}  // namespace swath::core
