// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

#include "core/geo/geodesy.h"

namespace swath::simulate {

/// The map around one place as a polynomial of local tangent coordinates, so that a straight beam can be followed on the map
/// without a call of PROJ per step. The fit is verified against PROJ; `worst()` is the largest difference found.
class MapPatch {
 public:
  /// Fits within +-`half` metres east and north of the origin and heights `low` to `high`. The map's coordinates are taken
  /// relative to the origin's easting and northing; heights are absolute.
  /// Throws Error where the CRS is not projected in metres, or where no polynomial of degree 6 keeps 0.002 mm.
  MapPatch(const core::Crs& crs, const core::Geodetic& origin, double half, double low, double high);

  /// Tangent coordinates (east, north, up at the origin, m) to map (easting, northing relative, height).
  Eigen::Vector3d map_of(const Eigen::Vector3d& tangent) const;
  Eigen::Vector3d tangent_of(const Eigen::Vector3d& ecef) const { return tangent_R_ecef_ * (ecef - origin_ecef_); }
  Eigen::Vector3d direction_of(const Eigen::Vector3d& ecef_vector) const { return tangent_R_ecef_ * ecef_vector; }
  Eigen::Vector3d ecef_of(const Eigen::Vector3d& tangent) const { return origin_ecef_ + tangent_R_ecef_.transpose() * tangent; }

  const Eigen::Vector3d& map_origin() const { return map_origin_; }  ///< easting, northing of the origin; 0
  double convergence() const { return convergence_; }                ///< bearing of grid north from true north, clockwise, rad
  double worst() const { return worst_; }                            ///< m

 private:
  static constexpr int most_terms = 84;  // degree 6 in three variables
  Eigen::Matrix3d tangent_R_ecef_;
  Eigen::Vector3d origin_ecef_, map_origin_, centre_, scale_;
  double convergence_ = 0.0, worst_ = 0.0;
  int degree_ = 0;
  std::array<Eigen::Vector3d, most_terms> coefficients_;
};

}  // namespace swath::simulate
