// SPDX-License-Identifier: GPL-3.0-or-later
// Orientations as programs that match images take them: geo.txt of OpenDroneMap, and the table of Pix4D and Metashape.
//
// Both state yaw, pitch and roll of a body whose front is the image's upper edge: all are 0 where the camera looks down and the upper edge
// points to true north (Pix4D, "Yaw, Pitch, Roll and Omega, Phi, Kappa angles"). That is the body of an aircraft only where `mount` is 90
// deg.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/geo/frames.h"

namespace swath::calib {

struct Geolocation {
  std::string image;
  Eigen::Vector3d map = Eigen::Vector3d::Zero();        ///< easting, northing (or longitude, latitude in deg), height
  core::Attitude attitude;                              ///< upper_edge_attitude()
  double sigma_horizontal = 0.0, sigma_vertical = 0.0;  ///< m
};

/// Roll, pitch and heading of the image with its upper edge as the front.
core::Attitude upper_edge_attitude(const Eigen::Matrix3d& ned_R_camera);

/// CRS, then name x y z yaw pitch roll horizontal and vertical accuracy.
std::string geo_text(const std::string& crs, const std::vector<Geolocation>& images);

/// Comma separated: name, two coordinates, z, yaw, pitch, roll, accuracies; the names of the columns as a comment. Coordinates of a
/// geographic CRS are latitude, longitude, as its axes.
std::string geolocation_csv(const std::string& crs, const std::vector<Geolocation>& images, bool geographic);

}  // namespace swath::calib
