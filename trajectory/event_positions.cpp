// SPDX-License-Identifier: GPL-3.0-or-later
// Source: Jubanski and Mitishita 2005, section 3. An event in a gap or outside the fixes gets no position: nothing is extrapolated.
#include "trajectory/event_positions.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>

namespace swath::trajectory {

namespace {

EventPosition not_reached(Reach reach, size_t fixes) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  EventPosition e;
  e.reach = reach;
  e.fixes = fixes;
  for (Eigen::Vector3d* v : {&e.position, &e.velocity, &e.sigma, &e.velocity_sigma}) v->setConstant(nan);
  e.covariance.setConstant(nan);
  return e;
}

// From the frame of the computation to the axes of the place itself: a flight of 100 km turns the vertical by 0.9 deg.
EventPosition place(const PointState& s, const LocalFrame& frame, const FixWindow& w) {
  EventPosition e;
  e.reach = w.reach;
  e.fixes = w.size();
  e.position = frame.to_ecef(s.position());
  PointState::Matrix6 turn = PointState::Matrix6::Zero();
  turn.topLeftCorner<3, 3>() = local_frame(e.position).local_R_ecef * frame.local_R_ecef.transpose();
  turn.bottomRightCorner<3, 3>() = turn.topLeftCorner<3, 3>();
  e.velocity = turn.topLeftCorner<3, 3>() * s.velocity();
  e.covariance = turn * s.covariance * turn.transpose();
  e.sigma = e.covariance.diagonal().head<3>().cwiseSqrt();
  e.velocity_sigma = e.covariance.diagonal().tail<3>().cwiseSqrt();
  return e;
}

}  // namespace

bool usable(const core::GnssData& gnss, size_t i) {
  if (!std::isfinite(gnss.time[i]) || !gnss.position[i].allFinite() || !gnss.covariance[i].allFinite()) return false;
  return Eigen::LLT<Eigen::Matrix3d>(gnss.covariance[i]).info() == Eigen::Success;
}

EventPositions positions_at(const core::GnssData& gnss, const std::vector<double>& times, Interpolator method, const KinematicOptions& o) {
  const LocalFrame frame = local_frame(gnss.position.front());
  const PointFixes fixes = to_local(gnss, frame);
  const PointSmoother smoother(fixes);
  EventPositions out;
  out.longest_step = longest_step(fixes, o);
  for (size_t i = 1; i < fixes.size(); ++i) out.gaps += fixes.time[i] - fixes.time[i - 1] > out.longest_step;
  out.test = leave_one_out(fixes, smoother, o);
  out.empirical = out.test.of(method).rms;

  const auto state_at = [&](const FixWindow& w, double t) {
    switch (method) {
      case Interpolator::line:
        return polynomial_at(fixes, w, t, 1, o);
      case Interpolator::parabola:
        return polynomial_at(fixes, w, t, 2, o);
      case Interpolator::rts:
        return smoother.at(t);
      case Interpolator::kalman:
        break;
    }
    return interpolate(fixes, w, t, o);
  };
  for (const double t : times) {
    const FixWindow w = window_at(fixes.time, t, static_cast<size_t>(o.epochs), out.longest_step);
    out.events.push_back(reached(w.reach) ? place(state_at(w, t), frame, w) : not_reached(w.reach, w.size()));
  }
  return out;
}

}  // namespace swath::trajectory
