// SPDX-License-Identifier: GPL-3.0-or-later
#include "quality/binned_errors.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/statistics.h"

namespace swath::quality {
namespace {

constexpr double outermost_bin = 1e6;

}  // namespace

std::int32_t bin_of(double value, double width) {
  return static_cast<std::int32_t>(std::lround(std::clamp(value / width, -outermost_bin, outermost_bin)));
}

double bin_quantile(const Bins& bins, double share, double width) {
  double all = 0.0, below = 0.0;
  for (const auto& [bin, n] : bins) all += n;
  for (const auto& [bin, n] : bins) {
    if (below + n >= share * all) return (bin - 0.5 + (share * all - below) / n) * width;
    below += n;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

Bins distances_from(const Bins& bins, double middle, double width) {
  Bins out;
  for (const auto& [bin, n] : bins) out[bin_of(std::abs(bin * width - middle), width)] += n;
  return out;
}

BinnedStatistics statistics_of(const ErrorSums& s, const Bins& bins, double width) {
  const auto n = static_cast<double>(s.n);
  BinnedStatistics out{s.n};
  const auto quantile = [width](const Bins& of, double share) { return std::max(0.0, bin_quantile(of, share, width)); };
  out.mean = s.sum / n;
  out.rms = std::sqrt(s.squares / n);
  out.std = s.n < 2 ? std::nan("") : std::sqrt(std::max(0.0, s.squares - s.sum * out.mean) / (n - 1.0));
  out.median = bin_quantile(bins, 0.5, width);
  const Bins sizes = distances_from(bins, 0.0, width);
  out.nmad = s.n == 0 ? out.mean : core::mad_to_sigma * quantile(distances_from(bins, out.median, width), 0.5);
  out.q68 = s.n == 0 ? out.mean : quantile(sizes, 0.683);
  out.q90 = s.n == 0 ? out.mean : quantile(sizes, 0.90);
  out.q95 = s.n == 0 ? out.mean : quantile(sizes, 0.95);
  return out;
}

}  // namespace swath::quality
