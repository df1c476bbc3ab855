// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/statistics.h"

#include <algorithm>
#include <cstddef>

namespace swath::core {
namespace {

double order_statistic(std::vector<double>& values, size_t number) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(number);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace

double quantile(std::vector<double> values, double share, double none) {
  return values.empty() ? none : order_statistic(values, static_cast<size_t>(share * static_cast<double>(values.size() - 1)));
}

double interpolated_quantile(std::vector<double>& values, double share) {
  const double at = share * static_cast<double>(values.size() - 1);
  const auto number = static_cast<size_t>(at);
  const double low = order_statistic(values, number);
  if (number + 1 == values.size()) return low;
  const double high = *std::min_element(values.begin() + static_cast<std::ptrdiff_t>(number) + 1, values.end());
  return low + (at - static_cast<double>(number)) * (high - low);
}

double median(std::vector<double> values, double none) { return values.empty() ? none : order_statistic(values, values.size() / 2); }

double median_step(const std::vector<double>& values) {
  std::vector<double> steps;
  for (size_t i = 1; i < values.size(); ++i) steps.push_back(values[i] - values[i - 1]);
  return median(std::move(steps), 0.0);
}

}  // namespace swath::core
