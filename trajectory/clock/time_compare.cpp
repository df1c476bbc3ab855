// SPDX-License-Identifier: GPL-3.0-or-later
// Source: Reis, Camargo, Tommaselli (2011): two techniques side by side, bias and rms per axis.
#include "trajectory/clock/time_compare.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>

#include "core/geo/geodesy.h"

namespace swath::trajectory {
namespace {

double instant(const core::EventTags& e, size_t i) { return e.time[i] + e.latency; }

std::vector<size_t> by_time(const core::EventTags& e) {
  std::vector<size_t> order(e.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return e.time[a] < e.time[b]; });
  return order;
}

/// For each event of `a` the nearest of `b`; `shift`: epoch of a minus that of b.
std::vector<std::optional<size_t>> nearest(const core::EventTags& a, const core::EventTags& b, double shift) {
  const std::vector<size_t> order = by_time(b);
  std::vector<std::optional<size_t>> out(a.size());
  if (b.size() == 0) return out;
  for (size_t i = 0; i < a.size(); ++i) {
    const double t = instant(a, i) + shift;
    auto at = std::lower_bound(order.begin(), order.end(), t, [&](size_t k, double v) { return instant(b, k) < v; });
    if (at == order.end() || (at != order.begin() && t - instant(b, *(at - 1)) <= instant(b, *at) - t)) --at;
    out[i] = *at;
  }
  return out;
}

}  // namespace

TimeComparison compare(const core::EventTags& first, const core::EventTags& second, EventMatch match, double tolerance) {
  const double shift = first.epoch - second.epoch;
  std::vector<std::optional<size_t>> partner(first.size());
  if (match == EventMatch::id) {
    std::multimap<std::string, size_t> names;
    for (size_t k = 0; k < second.size(); ++k) names.emplace(second.id[k], k);
    for (size_t i = 0; i < first.size(); ++i)
      if (const auto at = names.find(first.id[i]); at != names.end()) {
        partner[i] = at->second;
        names.erase(at);
      }
  } else {
    partner = nearest(first, second, shift);
    const auto back = nearest(second, first, -shift);
    for (size_t i = 0; i < first.size(); ++i)
      if (partner[i] && back[*partner[i]] != i) partner[i].reset();
  }
  TimeComparison out;
  std::vector<double> all, trusted, sigma_all, sigma_trusted;
  for (size_t i = 0; i < first.size(); ++i) {
    if (!partner[i]) continue;
    const size_t k = *partner[i];
    TimePair p{i, k, instant(second, k), instant(first, i) + shift - instant(second, k), 0, 0, false};
    if (std::abs(p.difference) > tolerance) continue;
    if (first.sigma[i] > 0 || second.sigma[k] > 0) p.sigma = std::hypot(first.sigma[i], second.sigma[k]);
    p.strip = first.strip[i] != 0 ? first.strip[i] : second.strip[k];
    p.doubtful = first.doubtful[i] || second.doubtful[k];
    all.push_back(p.difference);
    sigma_all.push_back(p.sigma);
    if (!p.doubtful) {
      trusted.push_back(p.difference);
      sigma_trusted.push_back(p.sigma);
    }
    out.pairs.push_back(p);
  }
  out.only_first = first.size() - out.pairs.size();
  out.only_second = second.size() - out.pairs.size();
  out.all = spread_of(all, sigma_all);
  out.trusted = spread_of(trusted, sigma_trusted);
  return out;
}

Spread spread_of(const std::vector<double>& d, const std::vector<double>& sigmas) {
  Spread out;
  out.n = d.size();
  if (d.empty()) return out;
  const auto n = static_cast<double>(d.size());
  double square = 0, ratio = 0, about = 0;
  bool known = sigmas.size() == d.size();
  for (size_t i = 0; i < d.size(); ++i) {
    out.bias += d[i] / n;
    square += d[i] * d[i];
    out.largest = std::max(out.largest, std::abs(d[i]));
    known = known && sigmas[i] > 0;
    if (known) ratio += d[i] * d[i] / (sigmas[i] * sigmas[i]);
  }
  for (const double v : d) about += (v - out.bias) * (v - out.bias);
  out.rms = std::sqrt(square / n);
  if (d.size() > 1) out.standard = std::sqrt(about / (n - 1));
  if (known) out.error_ratio = std::sqrt(ratio / n);
  return out;
}

ShiftDrift shift_and_drift(const std::vector<TimePair>& pairs, const core::EventTags& first) {
  ShiftDrift out;
  if (pairs.empty()) return out;
  const auto n = static_cast<double>(pairs.size());
  const double start = first.time[pairs.front().first];
  double t_mean = 0, d_mean = 0;
  for (const TimePair& p : pairs) {
    t_mean += (first.time[p.first] - start) / n;
    d_mean += p.difference / n;
  }
  double tt = 0, td = 0;
  for (const TimePair& p : pairs) {
    const double t = first.time[p.first] - start - t_mean;
    tt += t * t;
    td += t * (p.difference - d_mean);
  }
  if (tt > 0) out.drift = td / tt;
  out.shift = d_mean - out.drift * t_mean;
  double square = 0;
  for (const TimePair& p : pairs) {
    const double left = p.difference - out.shift - out.drift * (first.time[p.first] - start);
    square += left * left;
  }
  out.rms_after = std::sqrt(square / n);
  return out;
}

PlaceComparison compare_places(const std::vector<TimePair>& pairs, const core::EventTags& second, const Trajectory& trajectory,
                               bool trusted_only) {
  PlaceComparison out;
  std::array<std::vector<double>, 3> axes;
  std::vector<double> lengths;
  for (const TimePair& p : pairs) {
    if (trusted_only && p.doubtful) continue;
    const std::optional<Pose> pose = trajectory.pose_at(second.epoch + (p.time + 0.5 * p.difference));
    if (!pose) {
      ++out.outside;
      continue;
    }
    const core::Geodetic g = core::geodetic_of(pose->position);
    const Eigen::Vector3d v = core::ecef_R_ned(g.latitude, g.longitude).transpose() * pose->velocity;
    const double ground = std::hypot(v.x(), v.y());
    // In one time interval the body moves by its velocity, which has no part across its own track: the part across comes with turns alone,
    // and is taken against the track at the second technique's instant.
    const std::optional<Pose> at = trajectory.pose_at(second.epoch + p.time);
    Eigen::Vector2d track = ground > 0 ? Eigen::Vector2d(v.x(), v.y()) / ground : Eigen::Vector2d(1, 0);
    if (at) {
      const Eigen::Vector3d u = core::ecef_R_ned(g.latitude, g.longitude).transpose() * at->velocity;
      if (u.head<2>().norm() > 0) track = u.head<2>().normalized();
    }
    const Eigen::Vector3d d = v * p.difference;
    axes[0].push_back(d.head<2>().dot(track));
    axes[1].push_back(-d.x() * track.y() + d.y() * track.x());
    axes[2].push_back(-d.z());
    lengths.push_back(d.norm());
  }
  for (size_t a = 0; a < 3; ++a) out.axes[a] = spread_of(axes[a]);
  out.length = spread_of(lengths);
  return out;
}

PlaceComparison compare_places(const std::vector<TimePair>& pairs, double speed) {
  PlaceComparison out;
  out.is_along_alone = true;
  std::vector<double> along;
  for (const TimePair& p : pairs)
    if (!p.doubtful) along.push_back(p.difference * speed);
  out.axes[0] = spread_of(along);
  return out;
}

}  // namespace swath::trajectory
