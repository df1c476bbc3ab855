// SPDX-License-Identifier: GPL-3.0-or-later
// The histogram's median spreads the values of a bin evenly over it, its quantiles of |e| stand them at the bin's middle: wrong by at most
// one bin; deviations from the median by one more. A quantile among the values beyond `reach` is the extreme on that side.
#include "report/statistics.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"

namespace swath::report {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double p68 = 0.6827, p95 = 0.95;
constexpr double nmad_factor = 1.4826;  // 1 / inverse normal distribution at 3/4

// Reorders v.
double quantile_of(std::vector<double>& v, double p) {
  const double at = p * static_cast<double>(v.size() - 1);
  const auto k = static_cast<std::ptrdiff_t>(at);
  std::nth_element(v.begin(), v.begin() + k, v.end());
  const double low = v[k];
  if (static_cast<size_t>(k) + 1 == v.size()) return low;
  return low + (at - static_cast<double>(k)) * (*std::min_element(v.begin() + k + 1, v.end()) - low);
}

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

  s.median = quantile_of(errors, 0.5);
  std::vector<double> deviations(errors.size());
  std::transform(errors.begin(), errors.end(), deviations.begin(), [&](double e) { return std::abs(e - s.median); });
  s.nmad = nmad_factor * quantile_of(deviations, 0.5);
  for (double& e : errors) e = std::abs(e);
  s.q68 = quantile_of(errors, p68);
  s.q95 = quantile_of(errors, p95);
  return s;
}

StreamingStatistics::StreamingStatistics(double bin, double reach)
    : bin_(bin), reach_(reach), minimum_(std::numeric_limits<double>::infinity()), maximum_(-minimum_) {
  constexpr double most_bins = 1e7;
  if (!(bin > 0.0) || !(reach > 0.0) || 2.0 * reach / bin > most_bins)
    throw core::Error("a histogram needs a positive bin and reach, and at most 10 million bins", "report.statistics");
  counts_.assign(static_cast<size_t>(std::ceil(2.0 * reach / bin)) + 2, 0);
}

void StreamingStatistics::add(double error) {
  if (!std::isfinite(error)) {
    ++skipped_;
    return;
  }
  ++n_;
  const double step = error - mean_;
  mean_ += step / static_cast<double>(n_);
  m2_ += step * (error - mean_);
  minimum_ = std::min(minimum_, error);
  maximum_ = std::max(maximum_, error);
  const double at = std::clamp(std::floor((error + reach_) / bin_) + 1.0, 0.0, static_cast<double>(counts_.size() - 1));
  ++counts_[static_cast<size_t>(at)];
}

void StreamingStatistics::merge(const StreamingStatistics& o) {
  if (o.bin_ != bin_ || o.reach_ != reach_) throw core::Error("histograms of different bins cannot be merged", "report.statistics");
  skipped_ += o.skipped_;
  if (o.n_ == 0) return;
  const double mine = static_cast<double>(n_), theirs = static_cast<double>(o.n_), step = o.mean_ - mean_;
  mean_ += step * theirs / (mine + theirs);
  m2_ += o.m2_ + step * step * mine * theirs / (mine + theirs);
  n_ += o.n_;
  minimum_ = std::min(minimum_, o.minimum_);
  maximum_ = std::max(maximum_, o.maximum_);
  for (size_t k = 0; k < counts_.size(); ++k) counts_[k] += o.counts_[k];
}

double StreamingStatistics::quantile(double p) const {
  const double wanted = p * static_cast<double>(n_);
  double before = 0.0;
  for (size_t k = 0; k < counts_.size(); ++k) {
    const double here = static_cast<double>(counts_[k]);
    if (here > 0.0 && before + here >= wanted) {
      if (k == 0) return minimum_;
      if (k + 1 == counts_.size()) return maximum_;
      const double low = -reach_ + (static_cast<double>(k) - 1.0) * bin_;
      return std::clamp(low + bin_ * (wanted - before) / here, minimum_, maximum_);
    }
    before += here;
  }
  return maximum_;
}

// The smallest d for which a share p of the values lies within about +- d, each bin's values standing at its middle.
double StreamingStatistics::quantile_abs(double p, double about) const {
  const auto middle = [&](size_t k) {
    if (k == 0 && counts_[k] > 0) return minimum_;
    if (k + 1 == counts_.size() && counts_[k] > 0) return maximum_;
    return -reach_ + (static_cast<double>(k) - 0.5) * bin_;
  };
  // From `about` outward: always the nearer of the next bins below and above.
  size_t above = 0;
  while (above < counts_.size() && middle(above) < about) ++above;
  size_t below = above;  // bins [0, below) are still to come below
  const double wanted = p * static_cast<double>(n_);
  double seen = 0.0, distance = 0.0;
  while (below > 0 || above < counts_.size()) {
    const double down = below > 0 ? about - middle(below - 1) : std::numeric_limits<double>::infinity();
    const double up = above < counts_.size() ? middle(above) - about : std::numeric_limits<double>::infinity();
    const size_t k = down <= up ? --below : above++;
    if (counts_[k] == 0) continue;
    distance = std::min(down, up);
    seen += static_cast<double>(counts_[k]);
    if (seen >= wanted) break;
  }
  return distance;
}

Statistics StreamingStatistics::result() const {
  Statistics s;
  s.n = n_;
  s.skipped = skipped_;
  if (n_ == 0) return s;
  const double n = static_cast<double>(n_);
  s.mean = mean_;
  if (n_ > 1) s.std = std::sqrt(m2_ / (n - 1.0));
  s.rms = std::sqrt(m2_ / n + mean_ * mean_);
  s.minimum = minimum_;
  s.maximum = maximum_;
  s.max_abs = std::max(std::abs(minimum_), std::abs(maximum_));
  s.median = quantile(0.5);
  s.nmad = nmad_factor * quantile_abs(0.5, s.median);
  s.q68 = quantile_abs(p68, 0.0);
  s.q95 = quantile_abs(p95, 0.0);
  s.resolution = bin_;
  return s;
}

}  // namespace swath::report
