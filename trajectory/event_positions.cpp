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
EventPosition place(const PointState& s, const PointState::Matrix6& error, const LocalFrame& frame, const FixWindow& w) {
  EventPosition e;
  e.reach = w.reach;
  e.fixes = w.size();
  e.position = frame.to_ecef(s.position());
  PointState::Matrix6 turn = PointState::Matrix6::Zero();
  turn.topLeftCorner<3, 3>() = local_frame(e.position).local_R_ecef * frame.local_R_ecef.transpose();
  turn.bottomRightCorner<3, 3>() = turn.topLeftCorner<3, 3>();
  e.velocity = turn.topLeftCorner<3, 3>() * s.velocity();
  e.covariance = turn * error * turn.transpose();
  e.sigma = e.covariance.diagonal().head<3>().cwiseSqrt();
  e.velocity_sigma = e.covariance.diagonal().tail<3>().cwiseSqrt();
  return e;
}

}  // namespace

bool usable(const core::GnssData& gnss, size_t i) {
  if (!std::isfinite(gnss.time[i]) || !gnss.position[i].allFinite() || !gnss.covariance[i].allFinite()) return false;
  return Eigen::LLT<Eigen::Matrix3d>(gnss.covariance[i]).info() == Eigen::Success;
}

PointTrack track_of(const core::GnssData& gnss, const std::vector<LineSpan>& lines, const KinematicOptions& o) {
  return track_of(to_local(gnss, local_frame(gnss.position.front())), lines, o);
}

std::vector<EventPosition> positions_at(const PointTrack& track, const Eigen::Vector3d& origin, const std::vector<double>& times,
                                        Interpolator method, const KinematicOptions& o) {
  const LocalFrame frame = local_frame(origin);
  std::vector<EventPosition> out;
  for (const double t : times) {
    const FixWindow w = window_at(track.fixes.time, t, static_cast<size_t>(o.epochs), track.longest_step);
    if (!reached(w.reach)) {
      out.push_back(not_reached(w.reach, w.size()));
      continue;
    }
    Estimate e = estimate_at(track, w, t, method, o);
    // What the fixes have in common passes to the event as it is.
    e.error.topLeftCorner<3, 3>() += track.model().slow_of(stated_at(track.fixes, t));
    out.push_back(place(e.state, e.error, frame, w));
  }
  return out;
}

}  // namespace swath::trajectory
