// SPDX-License-Identifier: GPL-3.0-or-later
// The beam of each scanner model in the scanner frame (x forward, y right, z nadir).
#pragma once

#include <Eigen/Core>

#include "core/records/sensor.h"

namespace swath::georef {

/// A unit vector along the beam and its derivative with respect to the calibrated angle a'.
struct Beam {
  Eigen::Vector3d direction;
  Eigen::Vector3d by_angle;
};

/// Beams of one scanner. a' = s_a a + a0 is the calibrated angle, rad; w = sqrt(1 - forward^2).
///   mirror, polygon, beam:  (forward, w sin a', w cos a')
///   profile:                the same with a' = a0 whatever the record says
///   conical:                (sin c cos a', sin c sin a', cos c), c = cone_angle; a' = 0 forward, +90 deg starboard
///   palmer:                 reflection of a fixed beam at a turning mirror. With g = shaft_angle, t = mirror_tilt:
///       shaft             s = (-sin g, 0, cos g)
///       incident beam     i = (sin 2g, 0, -cos 2g): the beam that a mirror square to its shaft would send to the nadir
///                             (for g = 45 deg it comes from behind along x)
///       mirror's normal   n = cos t s + sin t (cos a' (cos g, 0, sin g) + sin a' (0, 1, 0))
///       beam              r = i - 2 (i . n) n
///       a' = 0 looks forward, +90 deg to starboard; the pattern is an ellipse of half axes near 2t along and 2t cos g across.
class BeamModel {
 public:
  explicit BeamModel(const core::Scanner& scanner);

  Beam operator()(double angle, double forward) const;

  /// True where the recorded angle takes no part (profile).
  bool ignores_record() const { return model_ == core::ScannerModel::profile; }
  /// True for the models of one form (forward, w sin a', w cos a').
  bool is_across() const { return model_ != core::ScannerModel::conical && model_ != core::ScannerModel::palmer; }

 private:
  core::ScannerModel model_;
  double sin_cone_, cos_cone_;
  Eigen::Vector3d incident_, normal_constant_, normal_cosine_, normal_sine_;
};

}  // namespace swath::georef
