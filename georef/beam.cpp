// SPDX-License-Identifier: GPL-3.0-or-later
// Source: law of reflection; the scanner types after Wehr & Lohr, "Airborne laser scanning - an introduction and overview", ISPRS Journal
// 54 (1999), section 3. Deviation: the beam leaves from one point; a real mirror shifts it by the offset of the incident beam from the
// shaft's axis (below 1 mm in common instruments), and the facets of a polygon are taken as alike.
#include "georef/beam.h"

#include <cmath>

namespace swath::georef {

using Eigen::Vector3d;

BeamModel::BeamModel(const core::Scanner& s)
    : model_(s.model), sin_cone_(std::sin(s.cone_angle.value)), cos_cone_(std::cos(s.cone_angle.value)) {
  const double g = s.shaft_angle.value, t = s.mirror_tilt.value;
  incident_ = {std::sin(2.0 * g), 0.0, -std::cos(2.0 * g)};
  normal_constant_ = std::cos(t) * Vector3d(-std::sin(g), 0.0, std::cos(g));
  normal_cosine_ = std::sin(t) * Vector3d(std::cos(g), 0.0, std::sin(g));
  normal_sine_ = std::sin(t) * Vector3d(0.0, 1.0, 0.0);
}

Beam BeamModel::operator()(double angle, double forward) const {
  const double s = std::sin(angle), c = std::cos(angle);
  switch (model_) {
    case core::ScannerModel::conical:
      return {{sin_cone_ * c, sin_cone_ * s, cos_cone_}, {-sin_cone_ * s, sin_cone_ * c, 0.0}};
    case core::ScannerModel::palmer: {
      const Vector3d n = normal_constant_ + c * normal_cosine_ + s * normal_sine_;
      const Vector3d n_by = c * normal_sine_ - s * normal_cosine_;
      const double along = incident_.dot(n);
      return {incident_ - 2.0 * along * n, -2.0 * (incident_.dot(n_by) * n + along * n_by)};
    }
    case core::ScannerModel::mirror:
    case core::ScannerModel::polygon:
    case core::ScannerModel::profile:
    case core::ScannerModel::beam:
      break;
  }
  const double w = std::sqrt(1.0 - forward * forward);
  return {{forward, w * s, w * c}, {0.0, w * c, -w * s}};
}

}  // namespace swath::georef
