// SPDX-License-Identifier: GPL-3.0-or-later
// Where one flight line has a roof: how it is displaced in plan, and its plane.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/target/roof_target.h"
#include "calib/target/target_beams.h"

namespace swath::calib {

/// Flight axes and the affine displacement in them.
struct RoofMotion {
  /// Displacement along, across; their derivatives; growth.
  enum Unknown : int { along, across, along_by_y, across_by_x, along_by_x, across_by_y, growth, unknowns };
  using Row = Eigen::Matrix<double, 1, unknowns>;

  Eigen::Vector2d x, y;  // unit vectors along, across: east, north
  Eigen::Vector2d centre{0, 0};
  Eigen::Matrix<double, unknowns, 1> value = Eigen::Matrix<double, unknowns, 1>::Zero();

  /// d(displacement along n at p) / d(unknowns), growth left out.
  Row along_normal(const Eigen::Vector2d& p, const Eigen::Vector2d& n) const {
    const double px = x.dot(p - centre), py = y.dot(p - centre), nx = x.dot(n), ny = y.dot(n);
    Row r = Row::Zero();
    r << nx, ny, nx * py, ny * px, nx * px, ny * py, 0.0;
    return r;
  }
  /// Its derivative along d.
  Row slope_normal(const Eigen::Vector2d& d, const Eigen::Vector2d& n) const {
    return along_normal(centre + d, n) - along_normal(centre, n);
  }
  Eigen::Vector2d at(const Eigen::Vector2d& p) const {
    const double px = x.dot(p - centre), py = y.dot(p - centre);
    return (value[along] + value[along_by_y] * py + value[along_by_x] * px) * x +
           (value[across] + value[across_by_x] * px + value[across_by_y] * py) * y;
  }
};

/// The roof's plane in one line, relative to an expected one: height at the centre, slopes along x and y of the motion.
struct RoofPlane {
  Eigen::Vector3d value = Eigen::Vector3d::Zero(), sigma = Eigen::Vector3d::Zero();
  double rms = 0.0;
  size_t n = 0;
  Eigen::Vector3d as_plane(const RoofMotion& m) const {
    const Eigen::Vector2d slope = value[1] * m.x + value[2] * m.y;
    return {value[0] - slope.dot(m.centre), slope.x(), slope.y()};
  }
};

/// By the pulses with one return a metre and more within the edges, moved back by `m`; robust. n is 0 where fewer than ten lie on a plane.
RoofPlane fit_roof_plane(const std::vector<Pierced>& pulses, const std::vector<Beamline>& beams, const RoofTarget& target,
                         const RoofMotion& m, double range_sigma);

}  // namespace swath::calib
