// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

#include "core/records/sensor.h"
#include "simulate/options.h"

namespace swath::simulate {

/// Where the scanner points at an instant: the angle after scale and offset (a'), the nod forward, and marks of the scan.
struct ScanState {
  double angle = 0.0;    ///< scan or encoder angle, rad; encoders in [0, 2 pi)
  double forward = 0.0;  ///< x component of the unit beam (patterns beam and multibeam; otherwise 0)
  bool positive = true;  ///< the angle grows
  bool edge = false;     ///< last pulse before the scan turns or starts anew
};

/// `t`: seconds from the start of the flight.
ScanState scan_at(const ScannerOptions& scanner, double t);

/// Unit beam vector in the scanner frame.
///   mirror, polygon, profile, beam, multibeam: (f, w sin a, w cos a), w = sqrt(1 - f^2)
///   conical: (sin c cos a, sin c sin a, cos c), c = half angle
///   palmer: shaft s = (-sin g, 0, cos g); mirror normal n = s cos t + (u cos a + v sin a) sin t, u = (cos g, 0, sin g), v = (0, 1, 0);
///           the fixed beam is the one that an untilted mirror sends to the nadir: i = z - 2 (z.s) s; beam = i - 2 (i.n) n
Eigen::Vector3d beam_of(const ScannerOptions& scanner, double angle, double forward);

/// Widest angle from the nadir axis.
double widest_angle(const ScannerOptions& scanner);

}  // namespace swath::simulate
