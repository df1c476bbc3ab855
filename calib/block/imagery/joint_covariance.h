// SPDX-License-Identifier: GPL-3.0-or-later
// What the errors of images' orientations have in common with those of their camera's values: a tilt and a principal point that move the
// ground by the same and against each other are each uncertain, and the ground is not. A file beside orientation.csv.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <map>
#include <string>

#include "calib/block/brown.h"

namespace swath::calib {

using CameraCovariance = Eigen::Matrix<double, camera_values, camera_values>;
/// Rows: east, north, up of the grid, m; rotation w about the camera's axes, rad (as ImageOrientation). Columns: camera_keys.
using PoseByCamera = Eigen::Matrix<double, 6, camera_values>;

/// By name. Values that are held have zeros.
struct JointCovariance {
  std::map<std::string, CameraCovariance> cameras;
  std::map<std::string, PoseByCamera> images;
};

inline constexpr const char* joint_covariance_file = "orientation_camera.csv";

std::string joint_covariance_csv(const std::string& crs, const JointCovariance& joint);
/// Throws core::Error with file and line: a column or a row missing, a row of another kind.
JointCovariance read_joint_covariance(const std::filesystem::path& file);

}  // namespace swath::calib
