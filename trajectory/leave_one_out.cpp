// SPDX-License-Identifier: GPL-3.0-or-later
// Source: Jubanski and Mitishita 2005, section 4 and tables 1-2. The fix left out is part of its difference, so that a difference holds the
// fix's own error too; and its neighbours lie two steps apart, where those of an event lie one: the figures are an upper bound for events.
#include "trajectory/leave_one_out.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "core/statistics.h"

namespace swath::trajectory {

namespace {

double median(std::vector<double> v) {
  if (v.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::sort(v.begin(), v.end());
  const size_t n = v.size();
  return 0.5 * (v[(n - 1) / 2] + v[n / 2]);
}

}  // namespace

std::string_view title_of(Interpolator i) {
  static constexpr std::array<std::string_view, interpolators.size()> titles{"Kalman", "straight line", "2nd degree", "RTS whole pass"};
  return titles[static_cast<size_t>(i)];
}

DifferenceStatistics statistics_of(const std::vector<Eigen::Vector3d>& differences, const std::vector<Eigen::Vector3d>& formal) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  DifferenceStatistics out;
  for (Eigen::Vector3d* v : {&out.mean, &out.sigma, &out.rms, &out.max_abs, &out.median_formal}) v->setConstant(nan);
  const auto n = static_cast<double>(differences.size());
  if (differences.empty()) return out;
  out.mean.setZero(), out.rms.setZero(), out.max_abs.setZero();
  for (const Eigen::Vector3d& d : differences) {
    out.mean += d / n;
    out.rms += d.cwiseAbs2() / n;
    out.max_abs = out.max_abs.cwiseMax(d.cwiseAbs());
  }
  out.rms = out.rms.cwiseSqrt().eval();
  if (differences.size() > 1) {
    out.sigma.setZero();
    for (const Eigen::Vector3d& d : differences) out.sigma += (d - out.mean).cwiseAbs2() / (n - 1.0);
    out.sigma = out.sigma.cwiseSqrt().eval();
  }
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> column;
    for (const Eigen::Vector3d& f : formal) column.push_back(f[axis]);
    out.median_formal[axis] = median(std::move(column));
  }
  return out;
}

LeaveOneOut leave_one_out(const PointFixes& fixes, const PointSmoother& smoother, const KinematicOptions& o) {
  LeaveOneOut out;
  out.acceleration = smoother.acceleration();
  out.step = core::median_step(fixes.time);
  const double longest = longest_step(fixes, o);
  std::array<std::vector<Eigen::Vector3d>, interpolators.size()> formal;
  for (size_t i = 0; i < fixes.size(); ++i) {
    const FixWindow w = window_without(fixes.time, i, static_cast<size_t>(o.epochs), longest);
    if (w.reach != Reach::full) {
      ++out.beside_gaps;
      continue;
    }
    const double t = fixes.time[i];
    out.fix.push_back(i);
    out.time.push_back(t);
    const std::array<PointState, interpolators.size()> states{interpolate(fixes, w, t, o), polynomial_at(fixes, w, t, 1, o),
                                                              polynomial_at(fixes, w, t, 2, o), smoother.without(i)};
    for (size_t k = 0; k < states.size(); ++k) {
      out.difference[k].push_back(fixes.position[i] - states[k].position());
      formal[k].push_back(states[k].covariance.diagonal().head<3>().cwiseSqrt());
    }
  }
  for (size_t k = 0; k < interpolators.size(); ++k) out.statistics[k] = statistics_of(out.difference[k], formal[k]);
  return out;
}

std::string LeaveOneOut::table() const {
  char line[200];
  std::snprintf(line, sizeof line, "%zu fixes left out one at a time, %g s apart; %zu without a full window; differences in cm\n\n",
                fix.size(), std::round(step * 1e6) / 1e6, beside_gaps);
  std::string out = line;
  std::snprintf(line, sizeof line, "%-16s%4s %9s %9s %9s %9s %14s\n", "", "", "sigma", "mean", "rms", "largest", "formal sigma");
  out += line;
  for (const Interpolator i : interpolators) {
    const DifferenceStatistics& s = of(i);
    for (int axis = 0; axis < 3; ++axis) {
      std::snprintf(line, sizeof line, "%-16s%4s %9.1f %9.1f %9.1f %9.1f %14.1f\n", axis == 0 ? std::string(title_of(i)).c_str() : "",
                    axis == 0   ? "E"
                    : axis == 1 ? "N"
                                : "H",
                    100 * s.sigma[axis], 100 * s.mean[axis], 100 * s.rms[axis], 100 * s.max_abs[axis], 100 * s.median_formal[axis]);
      out += line;
    }
  }
  return out;
}

}  // namespace swath::trajectory
