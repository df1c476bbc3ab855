// SPDX-License-Identifier: GPL-3.0-or-later
// Brandalize, table 10: r = R (0, sin b', -cos b') with b' = -b, turned by small angles about X, Y and Z.
#include "planning/error_budget.h"

#include <Eigen/Geometry>
#include <cmath>

namespace swath::planning {

using Eigen::Vector3d;

Vector3d ErrorBudget::total() const {
  Vector3d sum = Vector3d::Zero();
  for (const Vector3d& e : by_source) sum += e.cwiseAbs2();
  return sum.cwiseSqrt();
}

ErrorBudget error_budget(const ErrorSources& s, double height, double angle) {
  const double range = height / std::cos(angle);
  const Vector3d beam(0.0, std::sin(-angle), -std::cos(angle)), r = range * beam;
  const Vector3d swung(0.0, std::cos(angle), std::sin(-angle));  // d beam / d scan angle
  return {{s.roll * Vector3d::UnitX().cross(r), s.pitch * Vector3d::UnitY().cross(r), s.heading * Vector3d::UnitZ().cross(r),
           s.scan_angle * range * swung, s.range * beam, s.along * Vector3d::UnitX(), s.across * Vector3d::UnitY(),
           s.up * Vector3d::UnitZ()}};
}

double surface_sigma(const ErrorBudget& budget, double slope_along, double slope_across) {
  const Vector3d normal(-slope_along, -slope_across, 1.0);
  double sum = 0.0;
  for (const Vector3d& e : budget.by_source) sum += std::pow(normal.dot(e), 2);
  return std::sqrt(sum);
}

ErrorSources sources_of(const core::SensorSigma& sensor, const TrajectorySigma& trajectory, double height, double angle, double speed) {
  const double range = height / std::cos(angle);
  const auto both = [](double a, double b) { return std::hypot(a, b); };
  // The sigma of a beam's echo along and across is a quarter of its width (georef): across it acts as an error of the scan angle, along the
  // track as one of pitch.
  const double beam = 0.25 * sensor.beam_divergence.value;
  ErrorSources s;
  s.roll = both(sensor.roll.value, trajectory.roll_pitch.value);
  s.pitch = both(both(sensor.pitch.value, trajectory.roll_pitch.value), beam / std::cos(angle));
  s.heading = both(sensor.heading.value, trajectory.heading.value);
  s.scan_angle = both(both(sensor.scan_angle.value, sensor.scan_offset.value), both(sensor.scan_scale * angle, beam));
  s.range = both(both(sensor.range.value, sensor.range_offset.value), sensor.range_scale * range);
  s.across = both(sensor.lever_arm.value, trajectory.horizontal.value);
  s.along = both(s.across, speed * both(sensor.latency.value, sensor.time.value));
  s.up = both(sensor.lever_arm.value, trajectory.vertical.value);
  return s;
}

std::optional<double> forest_sigma(double slope, double penetration) {
  constexpr double least_penetration = 0.25;
  if (!(penetration >= least_penetration)) return std::nullopt;
  return 0.10 + 1.20 * std::tan(slope);
}

double without_reference(double sigma, double reference) {
  const double rest = sigma * sigma - reference * reference;
  return std::copysign(std::sqrt(std::abs(rest)), rest);
}

}  // namespace swath::planning
