// SPDX-License-Identifier: GPL-3.0-or-later
// Source: Jubanski and Mitishita 2005, section 4 and tables 1-2. The fix left out is part of its difference, so that a difference holds the
// fix's own error too; and its neighbours lie two steps apart, where those of an event lie one. The expected sigma knows both.
#include "trajectory/leave_one_out.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "core/statistics.h"

namespace swath::trajectory {

namespace {

double middle_of(std::vector<double> v) {
  if (v.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::sort(v.begin(), v.end());
  const size_t n = v.size();
  return 0.5 * (v[(n - 1) / 2] + v[n / 2]);
}

/// Each line or straight piece for itself; all turns together, and all stands.
std::vector<PieceTest> by_piece(const LeaveOneOut& all, const std::vector<FlightPiece>& pieces) {
  std::vector<PieceTest> out;
  std::vector<std::array<std::vector<Difference>, interpolators.size()>> differences;
  size_t at = 0;
  int number = 0;
  for (const FlightPiece& p : pieces) {
    const std::string name = p.name(p.kind == PieceKind::straight ? ++number : 0);
    const auto same = std::find_if(out.begin(), out.end(), [&](const PieceTest& t) { return t.name == name; });
    const auto k = static_cast<size_t>(same - out.begin());
    if (same == out.end()) out.push_back({name, 0, {}}), differences.emplace_back();
    for (; at < all.fix.size() && all.fix[at] < p.end; ++at, ++out[k].fixes)
      for (size_t m = 0; m < interpolators.size(); ++m) differences[k][m].push_back(all.difference[m][at]);
  }
  for (size_t k = 0; k < out.size(); ++k)
    for (size_t m = 0; m < interpolators.size(); ++m) out[k].statistics[m] = statistics_of(differences[k][m]);
  std::erase_if(out, [](const PieceTest& t) { return t.fixes == 0; });
  return out;
}

}  // namespace

DifferenceStatistics statistics_of(const std::vector<Difference>& differences) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  DifferenceStatistics out;
  for (Eigen::Vector3d* v : {&out.mean, &out.sigma, &out.rms, &out.max_abs, &out.median_formal, &out.median_expected, &out.ratio})
    v->setConstant(nan);
  const auto n = static_cast<double>(differences.size());
  if (differences.empty()) return out;
  out.mean.setZero(), out.rms.setZero(), out.max_abs.setZero(), out.ratio.setZero();
  for (const Difference& d : differences) {
    out.mean += d.value / n;
    out.rms += d.value.cwiseAbs2() / n;
    out.ratio += d.value.cwiseQuotient(d.expected).cwiseAbs2() / n;
    out.max_abs = out.max_abs.cwiseMax(d.value.cwiseAbs());
  }
  out.rms = out.rms.cwiseSqrt().eval();
  out.ratio = out.ratio.cwiseSqrt().eval();
  if (differences.size() > 1) {
    out.sigma.setZero();
    for (const Difference& d : differences) out.sigma += (d.value - out.mean).cwiseAbs2() / (n - 1.0);
    out.sigma = out.sigma.cwiseSqrt().eval();
  }
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> formal, expected;
    for (const Difference& d : differences) formal.push_back(d.formal[axis]), expected.push_back(d.expected[axis]);
    out.median_formal[axis] = middle_of(std::move(formal));
    out.median_expected[axis] = middle_of(std::move(expected));
  }
  return out;
}

LeaveOneOut leave_one_out(const PointTrack& track, const KinematicOptions& o) {
  const PointFixes& fixes = track.fixes;
  LeaveOneOut out;
  out.step = core::median_step(fixes.time);
  for (size_t i = 0; i < fixes.size(); ++i) {
    const FixWindow w = window_without(fixes.time, i, static_cast<size_t>(o.epochs), track.longest_step);
    if (w.reach != Reach::full) {
      ++out.beside_gaps;
      continue;
    }
    out.fix.push_back(i);
    out.time.push_back(fixes.time[i]);
    const Eigen::Matrix3d own = track.model().white_of(fixes.covariance[i]);
    for (size_t k = 0; k < interpolators.size(); ++k) {
      const Estimate e = estimate_without(track, i, w, interpolators[k], o);
      out.difference[k].push_back({fixes.position[i] - e.state.position(), e.state.covariance.diagonal().head<3>().cwiseSqrt(),
                                   (e.error.topLeftCorner<3, 3>() + own).diagonal().cwiseSqrt()});
    }
  }
  for (size_t k = 0; k < interpolators.size(); ++k) out.statistics[k] = statistics_of(out.difference[k]);
  out.pieces = by_piece(out, track.pieces);
  return out;
}

std::string row_of(const Eigen::Vector3d& v, double factor, int decimals) {
  std::string out;
  char text[40];
  for (int axis = 0; axis < 3; ++axis) {
    if (std::isfinite(v[axis]))
      std::snprintf(text, sizeof text, "%7.*f", decimals, factor * v[axis]);
    else
      std::snprintf(text, sizeof text, "%7s", "-");
    out += text;
  }
  return out;
}

std::string LeaveOneOut::table() const {
  char line[240];
  std::snprintf(line, sizeof line, "%zu fixes left out one at a time, %g s apart; %zu without a full window; differences in cm\n\n",
                fix.size(), std::round(step * 1e6) / 1e6, beside_gaps);
  std::string out = line;
  std::snprintf(line, sizeof line, "%-16s%4s %9s %9s %9s %9s %9s %9s\n", "", "", "sigma", "mean", "rms", "largest", "expected", "ratio");
  out += line;
  static constexpr const char* axes[] = {"E", "N", "H"};
  for (const Interpolator i : interpolators) {
    const DifferenceStatistics& s = of(i);
    for (int axis = 0; axis < 3; ++axis) {
      std::snprintf(line, sizeof line, "%-16s%4s %9.1f %9.1f %9.1f %9.1f %9.1f %9.2f\n", axis == 0 ? std::string(title_of(i)).c_str() : "",
                    axes[axis], 100 * s.sigma[axis], 100 * s.mean[axis], 100 * s.rms[axis], 100 * s.max_abs[axis],
                    100 * s.median_expected[axis], s.ratio[axis]);
      out += line;
    }
  }
  out +=
      "\nexpected: median sigma of a difference by the motion model; ratio: rms of difference over that sigma\n\n"
      "Sigma of the differences by piece, E N H, cm; ratio of the Kalman filter\n\n";
  std::snprintf(line, sizeof line, "%-22s %6s", "", "fixes");
  out += line;
  for (const Interpolator i : interpolators) {
    std::snprintf(line, sizeof line, " %21s", std::string(title_of(i)).c_str());
    out += line;
  }
  out += "                 ratio\n";
  for (const PieceTest& p : pieces) {
    std::snprintf(line, sizeof line, "%-22s %6zu", p.name.c_str(), p.fixes);
    out += line;
    for (const DifferenceStatistics& s : p.statistics) out += " " + row_of(s.sigma, 100.0, 1);
    out += " " + row_of(p.statistics[0].ratio, 1.0, 2) + "\n";
  }
  return out;
}

}  // namespace swath::trajectory
