// SPDX-License-Identifier: GPL-3.0-or-later
#include "trajectory/clock/motion_curve.h"

#include <algorithm>

#include "core/statistics.h"

namespace swath::trajectory {
namespace {

constexpr double longest_steps = 5.0;

}  // namespace

/// Means over `width` of both times and values, so that no delay comes in.
Motion averaged(const Motion& m, double width) {
  if (!(width > 0)) return m;
  Motion out;
  size_t first = 0, last = 0;
  for (size_t i = 0; i < m.time.size(); ++i) {
    while (m.time[i] - m.time[first] > 0.5 * width) ++first;
    while (last + 1 < m.time.size() && m.time[last + 1] - m.time[i] <= 0.5 * width) ++last;
    double t = 0;
    Eigen::Vector3d v = Eigen::Vector3d::Zero();
    for (size_t k = first; k <= last; ++k) {
      t += m.time[k] - m.time[i];
      v += m.value[k];
    }
    const auto n = static_cast<double>(last - first + 1);
    out.time.push_back(m.time[i] + t / n);
    out.value.push_back(v / n);
    if (out.time.size() > 1 && !(out.time.back() > out.time[out.time.size() - 2])) {  // at the record's very ends
      out.time.pop_back();
      out.value.pop_back();
    }
  }
  return out;
}

MotionCurve::MotionCurve(const Motion& m) : m_(m), longest_(longest_steps * core::median_step(m.time)) {}

bool MotionCurve::at(double t, Eigen::Vector3d& value, Eigen::Vector3d& rate) const {
  const size_t n = m_.time.size();
  const auto after = std::upper_bound(m_.time.begin(), m_.time.end(), t);
  if (after == m_.time.begin() || after == m_.time.end()) return false;
  const auto k = static_cast<size_t>(after - m_.time.begin()) - 1;
  if (m_.time[k + 1] - m_.time[k] > longest_) return false;
  size_t first = k > 0 ? k - 1 : 0, last = std::min(n - 1, k + 2);
  while (first < k && m_.time[k] - m_.time[first] > longest_) ++first;
  while (last > k + 1 && m_.time[last] - m_.time[k + 1] > longest_) --last;
  value.setZero();
  rate.setZero();
  for (size_t i = first; i <= last; ++i) {
    double weight = 1, slope = 0;
    for (size_t j = first; j <= last; ++j) {
      if (j == i) continue;
      const double d = m_.time[i] - m_.time[j];
      slope = (slope * (t - m_.time[j]) + weight) / d;
      weight *= (t - m_.time[j]) / d;
    }
    value += weight * (m_.value[i] - m_.value[k]);
    rate += slope * (m_.value[i] - m_.value[k]);
  }
  value += m_.value[k];
  return true;
}

}  // namespace swath::trajectory
