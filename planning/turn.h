// SPDX-License-Identifier: GPL-3.0-or-later
// Turns between flight lines: the shortest way of at most a given curvature from one place and course to another (Dubins 1957).
#pragma once

#include <Eigen/Core>

namespace swath::planning {

/// Radius of a level turn, m: v^2 / (g tan bank). `bank` in rad, above 0 and below 90 deg.
double turn_radius(double speed, double bank);

/// Length of the shortest way, m. Courses in rad, clockwise from north; places east, north in m; `radius` above 0.
double turn_length(const Eigen::Vector2d& from, double course, const Eigen::Vector2d& to, double course_there, double radius);

}  // namespace swath::planning
