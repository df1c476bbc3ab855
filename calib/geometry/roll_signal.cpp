// SPDX-License-Identifier: GPL-3.0-or-later
// No published source. For level ground the down component of a return at y across is z = H / cos(roll) - y tan(roll), so that the slope of
// z over y in the body frame is minus the tangent of roll, and of roll less the terrain's slope where it is not level.
#include "calib/geometry/roll_signal.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/config/units.h"
#include "core/statistics.h"

namespace swath::calib {
namespace {

constexpr double bin = 0.1;             // s
constexpr int fewest_in_bin = 12;       // returns of a bin
constexpr double narrowest_bin = 0.05;  // standard deviation of y in the mean distance
constexpr int half_window = 20;         // bins on each side of the mean that is taken out
constexpr size_t fewest_roll_bins = 60;
constexpr double least_roll = 0.05 * core::degree;
constexpr double lag_step = 0.02;     // s
constexpr double independent = 15.0;  // bins after which slopes of terrain and canopy are new
constexpr double least_shared = 0.9;  // of the bins: fewer agree somewhere by chance

struct Tilt {
  double time = 0.0, tilt = 0.0;
};

/// Slope of the ground across by bins; time as georeferenced.
std::vector<Tilt> tilts_of(const core::Shots& s, const ShotGeometry& g) {
  std::vector<Tilt> out;
  for (size_t first = 0, end = 0; first < s.size(); first = end) {
    const double start = std::floor(s.time[first] / bin) * bin;
    double n = 0, y = 0, z = 0, yy = 0, yz = 0;
    for (end = first; end < s.size() && s.time[end] < start + bin; ++end) {
      const Eigen::Vector3d ray =
          g.range(s.range[end]) *
          (g.body_R_scanner() * g.beam()(g.angle(s.angle[end]), s.forward.empty() ? 0.0 : s.forward[end]).direction);
      n += 1, y += ray.y(), z += ray.z(), yy += ray.y() * ray.y(), yz += ray.y() * ray.z();
    }
    if (end == first) ++end;
    if (n < fewest_in_bin) continue;
    const double variance = yy / n - (y / n) * (y / n);
    if (!(std::sqrt(std::max(variance, 0.0)) > narrowest_bin * std::abs(z / n))) continue;
    out.push_back({g.time(start + 0.5 * bin), -std::atan((yz / n - (y / n) * (z / n)) / variance)});
  }
  return out;
}

double interpolated(const std::vector<double>& time, const std::vector<double>& value, double t) {
  const auto at = std::lower_bound(time.begin(), time.end(), t);
  if (at == time.begin() || at == time.end()) return std::nan("");
  const auto i = static_cast<size_t>(at - time.begin());
  if (time[i] - time[i - 1] > 0.5) return std::nan("");
  const double w = (t - time[i - 1]) / (time[i] - time[i - 1]);
  return (1 - w) * value[i - 1] + w * value[i];
}

/// Less the mean over the window about each; not a number where it is not whole.
std::vector<double> without_slow(const std::vector<double>& v) {
  std::vector<double> sum(v.size() + 1, 0.0), out(v.size(), std::nan(""));
  std::vector<size_t> good(v.size() + 1, 0);
  for (size_t i = 0; i < v.size(); ++i) {
    const bool finite = std::isfinite(v[i]);
    sum[i + 1] = sum[i] + (finite ? v[i] : 0.0);
    good[i + 1] = good[i] + finite;
  }
  for (size_t i = 0; i < v.size(); ++i) {
    const size_t a = i >= half_window ? i - half_window : 0, b = std::min(v.size(), i + half_window + 1);
    const size_t n = good[b] - good[a];
    if (std::isfinite(v[i]) && n >= half_window) out[i] = v[i] - (sum[b] - sum[a]) / static_cast<double>(n);
  }
  return out;
}

/// One pass: tilts on an even grid, roll around it.
struct Series {
  std::vector<double> tilt;  ///< by bins
  std::vector<double> roll;  ///< by lag steps, from `before` of them ahead of the first bin
  long before = 0;
};

constexpr long steps_of_bin = 5;  // lag steps

Series series_of(const PassSample& p, const ShotGeometry& g, const core::TrajectoryData& d, double search) {
  Series out;
  const std::vector<Tilt> tilts = tilts_of(p.shots, g);
  if (tilts.empty()) return out;
  const double start = tilts.front().time;
  const auto bins = static_cast<size_t>(std::lround((tilts.back().time - start) / bin)) + 1;
  std::vector<double> raw(bins, std::nan(""));
  for (const Tilt& t : tilts) raw[static_cast<size_t>(std::lround((t.time - start) / bin))] = t.tilt;
  out.tilt = without_slow(raw);
  out.before = std::lround(search / lag_step);
  const long all = static_cast<long>(bins) * steps_of_bin + 2 * out.before;
  // Roll with the same mean taken out at every phase of the lag steps.
  std::vector<double> roll(static_cast<size_t>(all));
  for (long k = 0; k < all; ++k)
    roll[static_cast<size_t>(k)] = interpolated(d.time, d.roll, start + static_cast<double>(k - out.before) * lag_step);
  out.roll.assign(roll.size(), std::nan(""));
  for (long phase = 0; phase < steps_of_bin; ++phase) {
    std::vector<double> part;
    for (long k = phase; k < all; k += steps_of_bin) part.push_back(roll[static_cast<size_t>(k)]);
    part = without_slow(part);
    for (size_t k = 0; k < part.size(); ++k) out.roll[static_cast<size_t>(phase) + k * steps_of_bin] = part[k];
  }
  return out;
}

struct Sums {
  double xx = 0, xy = 0, yy = 0;
  size_t n = 0;
  double correlation() const { return xx > 0 && yy > 0 ? xy / std::sqrt(xx * yy) : 0.0; }
};

Sums sums_at(const std::vector<Series>& all, long lag, double limit) {
  Sums s;
  for (const Series& k : all)
    for (size_t i = 0; i < k.tilt.size(); ++i) {
      const long at = static_cast<long>(i) * steps_of_bin + k.before + lag;
      if (at < 0 || at >= static_cast<long>(k.roll.size())) continue;
      const double x = k.roll[static_cast<size_t>(at)], y = k.tilt[i];
      if (!std::isfinite(x + y) || std::abs(y) > limit) continue;
      s.xx += x * x, s.xy += x * y, s.yy += y * y, ++s.n;
    }
  return s;
}

}  // namespace

std::optional<RollSignal> roll_signal(const std::vector<PassSample>& profiles, const ShotGeometry& geometry, const core::TrajectoryData& d,
                                      double search) {
  std::vector<Series> all;
  std::vector<double> sizes;
  for (const PassSample& p : profiles) {
    all.push_back(series_of(p, geometry, d, search));
    for (const double t : all.back().tilt)
      if (std::isfinite(t)) sizes.push_back(std::abs(t));
  }
  const double limit = 4 * core::mad_to_sigma * core::median(std::move(sizes), 0.0);
  const Sums now = sums_at(all, 0, limit);
  if (now.n < fewest_roll_bins || std::sqrt(now.xx / static_cast<double>(now.n)) < least_roll) return std::nullopt;
  RollSignal out;
  out.bins = now.n;
  out.factor = now.xy / now.xx;
  out.correlation = out.best = now.correlation();
  out.sigma = std::sqrt(std::max(0.0, now.yy - now.xy * now.xy / now.xx) / static_cast<double>(now.n) / now.xx * independent);
  const long most = std::lround(search / lag_step);
  for (long lag = -most; lag <= most; ++lag) {
    const Sums s = sums_at(all, lag, limit);
    if (static_cast<double>(s.n) < least_shared * static_cast<double>(now.n) || s.correlation() <= out.best) continue;
    out.best = s.correlation();
    out.offset = static_cast<double>(lag) * lag_step;
  }
  return out;
}

}  // namespace swath::calib
