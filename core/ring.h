// SPDX-License-Identifier: GPL-3.0-or-later
// Closed lines in the plane.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace swath::core {

/// Area within the closed line, positive where it runs counter-clockwise; the last vertex may repeat the first.
double signed_area(const std::vector<Eigen::Vector2d>& ring);

/// Does the side from `a` to `b` cross the half line from (x, y) eastward? The place lies inside a ring (or an area with islands) whose
/// sides do so an odd number of times. A side holds its lower end and not its upper one, and runs the same way for both its neighbours.
bool crosses_eastward(const Eigen::Vector2d& a, const Eigen::Vector2d& b, double x, double y);

}  // namespace swath::core
