// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/statistics.h"

#include <algorithm>
#include <cmath>

#include "core/distributions.h"
#include "core/statistics.h"

namespace swath::report {
namespace {

constexpr double p68 = 0.6827, p95 = 0.95;

}  // namespace

Statistics statistics(std::vector<double> errors) {
  Statistics s;
  const size_t given = errors.size();
  std::erase_if(errors, [](double e) { return !std::isfinite(e); });
  s.n = errors.size();
  s.skipped = given - errors.size();
  if (errors.empty()) return s;
  const double n = static_cast<double>(s.n);

  double sum = 0.0, squares = 0.0, about_mean = 0.0;
  for (const double e : errors) sum += e, squares += e * e;
  s.mean = sum / n;
  for (const double e : errors) about_mean += (e - s.mean) * (e - s.mean);
  if (s.n > 1) s.std = std::sqrt(about_mean / (n - 1.0));
  s.rms = std::sqrt(squares / n);
  const auto [low, high] = std::minmax_element(errors.begin(), errors.end());
  s.minimum = *low;
  s.maximum = *high;
  s.max_abs = std::max(std::abs(s.minimum), std::abs(s.maximum));

  s.median = core::interpolated_quantile(errors, 0.5);
  std::vector<double> deviations(errors.size());
  std::transform(errors.begin(), errors.end(), deviations.begin(), [&](double e) { return std::abs(e - s.median); });
  s.nmad = core::mad_to_sigma * core::interpolated_quantile(deviations, 0.5);
  for (double& e : errors) e = std::abs(e);
  s.q68 = core::interpolated_quantile(errors, p68);
  s.q95 = core::interpolated_quantile(errors, p95);
  return s;
}

}  // namespace swath::report
