// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulate/recorded_flight.h"

#include <algorithm>
#include <cmath>

#include "core/config/units.h"
#include "core/error.h"

namespace swath::simulate {

namespace {

constexpr double shortest = 2.0;           // s
constexpr double highest_latitude = 1.45;  // rad, as everywhere in the simulation
constexpr size_t fewest = 2 * SmoothSpline::channels;

core::Geodetic first_position(const core::TrajectoryData& d) {
  if (d.size() < fewest || d.time.back() - d.time.front() < shortest)
    throw core::usage_error("a trajectory to fly along needs 2 s and 12 records at least", "flight.along");
  for (const double latitude : d.latitude)
    if (std::abs(latitude) > highest_latitude) throw core::usage_error("the trajectory to fly along is too near to a pole", "flight.along");
  return {d.latitude.front(), d.longitude.front(), d.height.front()};
}

std::vector<double> since_first(const core::TrajectoryData& d) {
  std::vector<double> t;
  for (const double v : d.time) t.push_back(v - d.time.front());
  return t;
}

/// Plane coordinates and attitude; the heading goes on past a whole turn.
std::vector<SmoothSpline::Row> rows_of(const core::TrajectoryData& d, const LocalPlane& plane) {
  std::vector<SmoothSpline::Row> out;
  double heading = d.heading.front();
  for (size_t i = 0; i < d.size(); ++i) {
    heading += core::wrap_pi(d.heading[i] - heading);
    SmoothSpline::Row row;
    row << plane.plane_of({d.latitude[i], d.longitude[i], d.height[i]}).transpose(), d.roll[i], d.pitch[i], heading;
    out.push_back(row);
  }
  return out;
}

}  // namespace

RecordedFlight::RecordedFlight(const core::TrajectoryData& records, double knot_spacing)
    : plane_(first_position(records), records.height.front()),
      spline_(since_first(records), rows_of(records, plane_), knot_spacing),
      duration_(std::floor(records.time.back() - records.time.front() + 1e-6)) {
  const std::vector<double> time = since_first(records);
  const std::vector<SmoothSpline::Row> rows = rows_of(records, plane_);
  lines_.push_back({1, "trajectory", 0.0, duration_});
  for (size_t i = 0; i < rows.size(); ++i) {
    const SmoothSpline::Row off = spline_.at(time[i]).value - rows[i];
    for (size_t c = 0; c < 6; ++c) {
      const double v = off[static_cast<Eigen::Index>(c)];
      departure_.rms[c] += v * v;
      departure_.worst[c] = std::max(departure_.worst[c], std::abs(v));
    }
  }
  for (double& v : departure_.rms) v = std::sqrt(v / static_cast<double>(rows.size()));
}

Motion RecordedFlight::motion(double t) const {
  const SmoothSpline::At at = spline_.at(t);
  LocalPlane::State s;
  s.position = at.value.head<3>().transpose();
  s.velocity = at.rate.head<3>().transpose();
  s.acceleration = at.acceleration.head<3>().transpose();
  s.attitude = at.value.tail<3>().transpose();
  s.attitude_rate = at.rate.tail<3>().transpose();
  return plane_.motion_of(s);
}

}  // namespace swath::simulate
