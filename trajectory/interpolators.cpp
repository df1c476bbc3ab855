// SPDX-License-Identifier: GPL-3.0-or-later
// The error of an interpolator's position x is (x - s) + (s - truth), s the smoother's by the most likely motion. The first part is known;
// the second has the smoother's covariance and is independent of it, both being functions of the same fixes.
#include "trajectory/interpolators.h"

#include <algorithm>

namespace swath::trajectory {

namespace {

PointState state_at(const PointFixes& fixes, const FixWindow& w, double t, Interpolator method, const KinematicOptions& o) {
  if (method == Interpolator::kalman) return interpolate(fixes, w, t, o);
  return polynomial_at(fixes, w, t, method == Interpolator::line ? 1 : 2, o);
}

Estimate compared(const PointState& state, const PointState& smoothed) {
  const PointState::Vector6 off = state.x - smoothed.x;
  return {state, smoothed.covariance + off * off.transpose()};
}

}  // namespace

std::string_view title_of(Interpolator i) {
  static constexpr std::array<std::string_view, interpolators.size()> titles{"Kalman", "straight line", "2nd degree", "RTS whole pass"};
  return titles[static_cast<size_t>(i)];
}

PointTrack track_of(PointFixes fixes, const std::vector<LineSpan>& lines, const KinematicOptions& o) {
  const double longest = longest_step(fixes, o);
  std::vector<FlightPiece> pieces = lines.empty() ? pieces_by_course(fixes, o.turn_rate.value, longest) : pieces_by_line(fixes, lines);
  MotionModel model = fit_motion(fixes, level_pieces(fixes, pieces));
  PointSmoother smoother(fixes, std::move(model));
  return {std::move(fixes), longest, std::move(pieces), std::move(smoother)};
}

Estimate estimate_at(const PointTrack& track, const FixWindow& w, double t, Interpolator method, const KinematicOptions& o) {
  const PointState smoothed = track.smoother.at(t);
  if (method == Interpolator::rts) return {smoothed, smoothed.covariance};
  return compared(state_at(track.fixes, w, t, method, o), smoothed);
}

Estimate estimate_without(const PointTrack& track, size_t i, const FixWindow& w, Interpolator method, const KinematicOptions& o) {
  const PointState smoothed = track.smoother.without(i);
  if (method == Interpolator::rts) return {smoothed, smoothed.covariance};
  return compared(state_at(track.fixes, w, track.fixes.time[i], method, o), smoothed);
}

Eigen::Matrix3d stated_at(const PointFixes& fixes, double t) {
  const auto after = std::upper_bound(fixes.time.begin() + 1, fixes.time.end() - 1, t);
  const auto i = static_cast<size_t>(after - fixes.time.begin());
  const double share = std::clamp((t - fixes.time[i - 1]) / (fixes.time[i] - fixes.time[i - 1]), 0.0, 1.0);
  return (1.0 - share) * fixes.covariance[i - 1] + share * fixes.covariance[i];
}

}  // namespace swath::trajectory
