// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

#include "simulate/flight.h"

namespace swath::simulate {

/// Angular rate of `body` against inertial space (rad/s) and specific force (m/s^2), both in `body`.
struct Inertial {
  Eigen::Vector3d rate, force;
};
/// Earth rate, transport rate, Coriolis and normal gravity are taken out of the motion exactly (Savage 2000, ch. 4; gravity along the
/// ellipsoid's normal at the point).
Inertial inertial_of(const Motion& motion);

/// Velocity of a point fixed in `body`, `lever` from the IMU: north, east, down at the IMU, m/s.
Eigen::Vector3d velocity_at(const Motion& motion, const Eigen::Vector3d& lever);

/// Increments over [t - step, t]: integrals of rate and specific force along the body's turning axes (no coning, no sculling terms).
struct Increments {
  Eigen::Vector3d angle, velocity;
};
Increments increments_of(const Flight& flight, double t, double step);

}  // namespace swath::simulate
