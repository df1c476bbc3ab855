// SPDX-License-Identifier: GPL-3.0-or-later
// orientation.csv: a line per image.
#pragma once

#include <Eigen/Core>
#include <string>

#include "core/geo/frames.h"

namespace swath::calib {

struct ImageOrientation {
  Eigen::Vector3d map = Eigen::Vector3d::Zero();  ///< perspective centre: easting, northing, height of the CRS
  Eigen::Matrix3d grid_R_camera = Eigen::Matrix3d::Identity();
  core::Attitude attitude;  ///< of the body, from true north
  /// East, north, up of the grid, m; rotation w about the camera's axes, rad: camera_R_grid is exp(w) times the true one.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
};

/// Omega, phi, kappa of R = Rx(omega) Ry(phi) Rz(kappa), rad.
Eigen::Vector3d omega_phi_kappa_of(const Eigen::Matrix3d& grid_R_camera);
/// Its reverse.
Eigen::Matrix3d matrix_of_omega_phi_kappa(const Eigen::Vector3d& angles);

/// Decimals of easting and northing: 4; 10 where they are, or may be, degrees.
int plan_decimals(const Eigen::Vector3d& map);

/// The CRS that a comment above a table states, "crs: EPSG:25832+7837; ...", without the comment's mark; empty where it is another comment.
std::string crs_of_comment(const std::string& text);

/// Comments with the conventions, and the names of the columns.
std::string orientation_header(const std::string& crs);
std::string orientation_line(const std::string& image, const std::string& camera, int strip, const ImageOrientation& orientation);

}  // namespace swath::calib
