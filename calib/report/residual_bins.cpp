// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/report/residual_bins.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/config/units.h"

namespace swath::calib {
namespace {

using calib::Adjustment;
using calib::GroupResidual;
using calib::TieSet;

constexpr int most_bins = 10;

/// Sums on the way to a ResidualBin.
struct Sums {
  std::uint64_t groups = 0, rejected = 0, returns = 0, before_groups = 0;
  double before = 0.0, before2 = 0.0, after = 0.0, after2 = 0.0, returns2 = 0.0, largest_w = 0.0;

  void add(const GroupResidual& g) {
    if (g.rejected) {
      ++rejected;
      return;
    }
    ++groups;
    returns += g.returns;
    if (std::isfinite(g.before)) {
      ++before_groups;
      before += g.before;
      before2 += g.before * g.before;
    }
    after += g.after;
    after2 += g.after * g.after;
    returns2 += g.returns * g.rms * g.rms;
    largest_w = std::max(largest_w, std::abs(g.w));
  }
  ResidualBin bin(double low, double high) const {
    const auto n = static_cast<double>(groups), nb = static_cast<double>(before_groups);
    const double none = calib::not_known;
    ResidualBin out{low, high, groups, rejected, returns, none, none, none, none, none, none};
    if (nb > 0) {
      out.mean_before = before / nb;
      out.rms_before = std::sqrt(before2 / nb);
    }
    if (n > 0) {
      out.mean_after = after / n;
      out.rms_after = std::sqrt(after2 / n);
      out.largest_w = largest_w;
    }
    if (returns > 0) out.rms_returns = std::sqrt(returns2 / static_cast<double>(returns));
    return out;
  }
};

/// 1, 2 or 5 times a power of ten, so that a length has no more than most_bins bins.
double bin_step(double low, double high) {
  const double least = (high - low) / (most_bins - 1);
  if (!(least > 0.0)) return 1.0;
  const double power = std::pow(10.0, std::floor(std::log10(least)));
  for (const double k : {1.0, 2.0, 5.0})
    if (k * power >= least) return k * power;
  return 10.0 * power;
}

/// Planes by line id.
std::set<std::uint32_t> seen_by(const TieSet& ties, int line) {
  std::set<std::uint32_t> out;
  for (const calib::TieGroup& g : ties.groups)
    if (ties.lines[g.line].id == line) out.insert(g.plane);
  return out;
}

}  // namespace

double first_time(const TieSet& ties) {
  double first = std::numeric_limits<double>::infinity();
  for (const calib::TieLine& l : ties.lines) first = std::min(first, l.first);
  return std::isfinite(first) ? first : 0.0;
}

double bin_value(const GroupResidual& g, const TieSet& ties, BinBy by) {
  switch (by) {
    case BinBy::line:
      return ties.lines[g.line].id;
    case BinBy::angle:
      return core::to_degrees(g.angle);
    case BinBy::range:
      return g.range;
    case BinBy::time:
      break;
  }
  return g.time - first_time(ties);
}

std::vector<ResidualBin> residual_bins(const Adjustment& a, const TieSet& ties, BinBy by) {
  std::vector<double> values;
  values.reserve(a.groups.size());
  for (const GroupResidual& g : a.groups) values.push_back(bin_value(g, ties, by));
  if (values.empty()) return {};
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  const double step = by == BinBy::line ? 1.0 : bin_step(*low, *high);
  std::map<std::int64_t, Sums> sums;
  for (size_t k = 0; k < values.size(); ++k) sums[static_cast<std::int64_t>(std::floor(values[k] / step))].add(a.groups[k]);
  std::vector<ResidualBin> out;
  for (const auto& [index, s] : sums) {
    const double from = static_cast<double>(index) * step, to = static_cast<double>(index + 1) * step;
    out.push_back(s.bin(from, by == BinBy::line ? from : to));
  }
  return out;
}

ResidualBin residual_total(const Adjustment& a) {
  Sums s;
  for (const GroupResidual& g : a.groups) s.add(g);
  return s.bin(0.0, 0.0);
}

report::Statistics difference_statistics(const core::Grid& difference) {
  std::vector<double> values;
  for (const float h : difference.height)
    if (std::isfinite(h)) values.push_back(static_cast<double>(h));
  return report::statistics(std::move(values));
}

std::uint64_t common_planes(const TieSet& ties, int line_a, int line_b) {
  const auto a = seen_by(ties, line_a), b = seen_by(ties, line_b);
  return static_cast<std::uint64_t>(std::count_if(a.begin(), a.end(), [&](std::uint32_t plane) { return b.contains(plane); }));
}

std::uint64_t planes_of(const TieSet& ties, int line) { return seen_by(ties, line).size(); }

}  // namespace swath::calib
