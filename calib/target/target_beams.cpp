// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/target/target_beams.h"

#include <algorithm>
#include <cmath>

namespace swath::calib {

using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

constexpr double lookback = 10.0;  // m along the beam, for its direction

}  // namespace

void TargetPulses::halve() {
  const size_t n = size() / 2;
  const auto thin = [n](auto& column) {
    for (size_t i = 0; i < n; ++i) column[i] = column[2 * i];
    column.resize(n);
  };
  thin(time), thin(angle), thin(forward), thin(first), thin(last), thin(returns);
}

std::vector<Beamline> beamlines(const TargetPulses& p, const ShotGeometry& geometry, const trajectory::Trajectory& trajectory,
                                const RoofTarget& target) {
  std::vector<Beamline> out;
  out.reserve(p.size());
  trajectory::Cursor cursor(trajectory);
  for (size_t i = 0; i < p.size(); ++i) {
    const double t = geometry.time(p.time[i]);
    if (!cursor.seek(t)) continue;
    const trajectory::Pose pose = cursor.pose(t);
    const auto local = [&](double range) {
      return Vector3d(target.frame.local_R_ecef * (geometry.ecef_point(pose, {p.angle[i], p.forward[i], range}) - target.frame.origin));
    };
    const Vector3d first = local(p.first[i]);
    out.push_back({first, (local(p.first[i] - lookback) - first) / lookback, p.last[i] - p.first[i], p.returns[i], i});
  }
  return out;
}

std::vector<Pierced> pierce(const std::vector<Beamline>& beams, const Vector3d& plane) {
  std::vector<Pierced> out;
  out.reserve(beams.size());
  const Vector3d normal(-plane[1], -plane[2], 1.0);
  for (const Beamline& b : beams) {
    const double above = normal.dot(b.first) - plane[0], rise = normal.dot(b.back);
    if (rise < 0.1) continue;  // beams nearly level show nothing of a flat roof
    const Vector3d at = b.first - above / rise * b.back;
    out.push_back({at.head<2>(), -b.back.head<2>() / b.back.z(), above, above - rise * b.further, b.pulse});
  }
  return out;
}

Vector2d coarse_shift(const std::vector<Pierced>& pulses, const RoofTarget& target, double search, double& score) {
  constexpr size_t enough = 3000;
  const size_t every = pulses.size() / enough + 1;
  const auto gain = [&](const Vector2d& shift) {
    int sum = 0;
    for (size_t i = 0; i < pulses.size(); i += every)
      if (target.holds(pulses[i].place - shift)) sum += std::abs(pulses[i].first) < coarse_tolerance ? 1 : -1;
    return sum;
  };
  Vector2d best(0, 0);
  int highest = gain(best);
  for (double step = 1.0; step > 0.2; step *= 0.5) {
    const int n = step == 1.0 ? static_cast<int>(std::ceil(search)) : 2;
    const Vector2d start = best;
    Vector2d sum(0, 0);
    int ties = 0;
    highest = -1 << 30;
    for (int i = -n; i <= n; ++i)
      for (int j = -n; j <= n; ++j) {
        const Vector2d shift = start + step * Vector2d(i, j);
        if (shift.norm() > search + 2.0) continue;
        const int g = gain(shift);
        if (g > highest) {
          highest = g;
          sum.setZero();
          ties = 0;
        }
        if (g == highest) {
          sum += shift;
          ++ties;
        }
      }
    best = sum / std::max(ties, 1);
  }
  int on_roof = 0;
  for (size_t i = 0; i < pulses.size(); i += every) on_roof += target.holds(pulses[i].place - best);
  score = on_roof > 0 ? static_cast<double>(highest) / on_roof : 0.0;
  return best;
}

std::vector<double> frequent_heights(const std::vector<Pierced>& pulses, double reach) {
  constexpr double bin = 0.2;  // m
  constexpr size_t most = 4;
  const auto bins = static_cast<size_t>(2.0 * reach / bin) + 3;
  std::vector<double> count(bins, 0.0), smooth(bins, 0.0);
  for (const Pierced& p : pulses) {
    const double at = (p.first + reach) / bin + 1.0;
    if (at >= 1.0 && at < static_cast<double>(bins - 1)) count[static_cast<size_t>(at)] += 1.0;
  }
  for (size_t i = 1; i + 1 < bins; ++i) smooth[i] = count[i - 1] + count[i] + count[i + 1];
  std::vector<std::pair<double, double>> peaks;
  for (size_t i = 1; i + 1 < bins; ++i)
    if (smooth[i] >= fewest_on_roof && smooth[i] >= smooth[i - 1] && smooth[i] > smooth[i + 1])
      peaks.push_back({-smooth[i], (static_cast<double>(i) - 0.5) * bin - reach});
  std::sort(peaks.begin(), peaks.end());
  std::vector<double> out;
  for (size_t i = 0; i < std::min(peaks.size(), most); ++i) out.push_back(peaks[i].second);
  return out;
}

}  // namespace swath::calib
