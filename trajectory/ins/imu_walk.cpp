// SPDX-License-Identifier: GPL-3.0-or-later
#include "trajectory/ins/imu_walk.h"

#include <algorithm>
#include <cmath>

#include "core/config/units.h"
#include "core/error.h"

namespace swath::trajectory {
namespace {

using Eigen::Vector3d;

constexpr double no_time = 1e-6;                         // s: instants nearer than this are one (a double of GPS seconds resolves 2.4e-7)
constexpr double gap_share = 0.5;                        // of a step missing makes a gap
constexpr double bridge_step = 0.01;                     // s: longest increment of a bridge
constexpr double least_rate = 1e-3, least_force = 0.02;  // rad/s, m/s^2 by which a bridge may be off, at least
constexpr size_t neighbours = 100;                       // records on each side, at least, that show how much the motion changes

/// RMS by which a bridge over n records misses their mean rate: tried on the records of both sides of record k. Where they are too few for
/// that: the standard deviation of their rates. The worst axis.
double bridge_error(const std::vector<Vector3d>& values, const std::vector<double>& step, size_t k, size_t n, double least) {
  const size_t reach = std::max(neighbours, 4 * n);
  const size_t first = k > reach ? k - reach : 0, last = std::min(values.size(), k + reach);
  const auto rate = [&](size_t i) -> Vector3d { return values[i] / step[i]; };
  Vector3d squares = Vector3d::Zero();
  double tries = 0;
  const auto attempt = [&](size_t from, size_t until) {
    Vector3d sum = Vector3d::Zero();
    for (size_t i = from; i < until; ++i) {
      sum += rate(i);
      if (i < from + n + 1) continue;
      sum -= rate(i - n - 1);  // now of the n + 1 records up to i
      const Vector3d missed = (sum - rate(i)) / static_cast<double>(n) - 0.5 * (rate(i - n - 1) + rate(i));
      squares += missed.cwiseAbs2();
      ++tries;
    }
  };
  attempt(first, k);
  attempt(k, last);
  if (tries < 10) {
    Vector3d sum = Vector3d::Zero();
    squares.setZero();
    tries = static_cast<double>(last - first);
    for (size_t i = first; i < last; ++i) sum += rate(i);
    for (size_t i = first; i < last; ++i) squares += (rate(i) - sum / tries).cwiseAbs2();
  }
  return std::max(least, std::sqrt((squares / tries).maxCoeff()));
}

}  // namespace

Bridging ImuPath::bridged_within(double t0, double t1) const {
  Bridging out;
  auto g = std::partition_point(gaps.begin(), gaps.end(), [&](const BridgedGap& gap) { return gap.start + gap.length <= t0; });
  for (; g != gaps.end() && g->start < t1; ++g) {
    const double seconds = std::min(t1, g->start + g->length) - std::max(t0, g->start);
    out.seconds += seconds;
    out.turn += seconds * g->length * g->rate_sigma * g->rate_sigma;
    out.push += seconds * g->length * g->force_sigma * g->force_sigma;
  }
  return out;
}

ImuPath make_path(core::ImuData imu, double max_gap) {
  ImuPath path;
  std::vector<size_t> before;  // records with a gap before them
  for (size_t k = 1; k < imu.size(); ++k) {
    const double missing = imu.time[k] - imu.step[k] - imu.time[k - 1];
    if (missing <= gap_share * imu.step[k]) continue;
    if (missing > max_gap)
      throw core::Error("the IMU has a gap of " + core::format_number(std::round(missing * 1e4) / 1e4) + " s, longer than " +
                            core::format_number(max_gap) + " s",
                        "IMU record " + std::to_string(k + 1) + ", GPS time " + std::to_string(imu.time[k]),
                        "cut the survey there, or raise max_gap");
    before.push_back(k);
  }
  if (before.empty()) {
    for (size_t k = 1; k < imu.size(); ++k) imu.step[k] = imu.time[k] - imu.time[k - 1];
    path.imu = std::move(imu);
    return path;
  }
  core::ImuData& out = path.imu;
  size_t at = 0;
  for (size_t k = 0; k < imu.size(); ++k) {
    if (at < before.size() && before[at] == k) {
      ++at;
      const double start = imu.time[k - 1], length = imu.time[k] - imu.step[k] - start;
      const auto missing = static_cast<size_t>(std::max(1.0, std::round(length / imu.step[k])));
      const auto sigma = [&](const std::vector<Vector3d>& values, double least) {
        // The motion within the gap may be off by more than at its end: half of it counts as well.
        return std::max(bridge_error(values, imu.step, k, missing, least), bridge_error(values, imu.step, k, (missing + 1) / 2, least));
      };
      path.gaps.push_back({start, length, sigma(imu.angle, least_rate), sigma(imu.velocity, least_force)});
      const auto pieces = static_cast<size_t>(std::ceil(length / bridge_step));
      const double step = length / static_cast<double>(pieces);
      const Vector3d rate0 = imu.angle[k - 1] / imu.step[k - 1], rate1 = imu.angle[k] / imu.step[k];
      const Vector3d force0 = imu.velocity[k - 1] / imu.step[k - 1], force1 = imu.velocity[k] / imu.step[k];
      for (size_t p = 0; p < pieces; ++p) {
        const double share = (static_cast<double>(p) + 0.5) / static_cast<double>(pieces);
        out.time.push_back(start + step * static_cast<double>(p + 1));
        out.step.push_back(step);
        out.angle.push_back(step * ((1 - share) * rate0 + share * rate1));
        out.velocity.push_back(step * ((1 - share) * force0 + share * force1));
        path.bridged.push_back(1);
      }
    }
    out.time.push_back(imu.time[k]);
    out.step.push_back(k == 0 ? imu.step[0] : imu.time[k] - out.time[out.time.size() - 2]);
    out.angle.push_back(imu.angle[k]);
    out.velocity.push_back(imu.velocity[k]);
    path.bridged.push_back(0);
  }
  return path;
}

ImuWalk::ImuWalk(const ImuPath& path, double time) : path_(&path), time_(std::clamp(time, path.begin(), path.end())) {
  const auto& t = path.imu.time;
  k_ = std::min<size_t>(static_cast<size_t>(std::lower_bound(t.begin(), t.end(), time_) - t.begin()), t.size() - 1);
}

bool ImuWalk::next(double until, Increment& piece) {
  const double goal = std::clamp(until, path_->begin(), path_->end());
  if (std::abs(goal - time_) < no_time) return false;
  const core::ImuData& imu = path_->imu;
  const bool onward = goal > time_;
  double target = 0;
  for (;;) {
    if (onward) {
      if (time_ > imu.time[k_] - no_time && k_ + 1 < imu.size()) ++k_;
      target = std::min(goal, imu.time[k_]);
      if (goal > target - no_time && goal < target + no_time) target = goal;
    } else {
      if (time_ < path_->edge(k_) + no_time && k_ > 0) --k_;
      target = std::max(goal, path_->edge(k_));
    }
    if (std::abs(target - time_) >= no_time) break;
    if (std::abs(goal - target) < no_time) return false;
    time_ = target;
  }
  piece = increment_of(imu, k_);
  const double share = (target - time_) / piece.step;
  piece.angle *= share;
  piece.velocity *= share;
  piece.step *= share;
  time_ = target;
  return true;
}

}  // namespace swath::trajectory
