// SPDX-License-Identifier: GPL-3.0-or-later
// Photographs with their orientations and cameras: what colours of points and orthophotos are taken from.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "calib/block/block_config.h"
#include "calib/block/block_frame.h"
#include "calib/block/image_block.h"
#include "calib/block/imagery/black_rim.h"
#include "calib/block/imagery/joint_covariance.h"

namespace swath::calib {

/// The map that points and grids are on, in metres.
struct MetreMap {
  std::string crs = "local";  ///< or a CRS with PROJ
  double unit = 1.0;          ///< metres per horizontal unit of the CRS
  double vertical_unit = 1.0;

  Eigen::Vector3d in_units(const Eigen::Vector3d& metres) const {
    return {metres.x() / unit, metres.y() / unit, metres.z() / vertical_unit};
  }
  Eigen::Vector3d in_metres(const Eigen::Vector3d& units) const { return {units.x() * unit, units.y() * unit, units.z() * vertical_unit}; }
};

/// One table of orientations and the folder of its photographs, names as they are opened. What `swath block` writes beside the table
/// (joint_covariance_file) is read, too, where it is there: without it cameras count as exact.
struct PhotoSource {
  std::filesystem::path folder, orientation;
  std::string crs;  ///< where the table states none; empty: that of the map
  std::vector<CameraConfig> cameras;
  std::string camera_place;  ///< where `cameras` come from, for messages
};

struct OrientedImage {
  std::string name;
  std::filesystem::path file;
  std::uint32_t camera = 0;
  Eigen::Vector3d map = Eigen::Vector3d::Zero();    ///< perspective centre on the map, m
  Eigen::Vector3d local = Eigen::Vector3d::Zero();  ///< the same in the frame, m
  Eigen::Matrix3d camera_R_local = Eigen::Matrix3d::Identity();
  /// Perspective centre in the frame, m; rotation w about the camera's axes, rad: camera_R_local is exp(w) times the true one. Zero where
  /// the table has none.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  PoseByCamera with_camera = PoseByCamera::Zero();  ///< covariance with the camera's values
  bool has_covariance = false;                      ///< the table states it
  double steepest = 0.0;                            ///< tangent of the largest angle to the vertical at which it sees anything
};

/// Local Cartesian frame: east, north, up at the first image.
struct OrientedImages {
  MetreMap map;
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();  ///< of the frame, units of the map's CRS
  std::vector<CameraConfig> configs;
  std::vector<BlockCamera> cameras;
  std::vector<CameraCovariance> camera_covariance;  ///< per camera
  std::vector<BlackRim> rims;                       ///< per camera: what its photographs do not show
  std::vector<OrientedImage> images;
  std::vector<std::string> without_file;  ///< oriented images that the folders do not have
  int bits = 8;                           ///< of the photographs: 8, or 16 where one has them

  /// Does a place on a camera's photographs lie on their rim, or nearer to it than `margin` pixels?
  bool is_rim(std::uint32_t camera, const Eigen::Vector2d& pixel, int margin) const {
    return camera < rims.size() && rims[camera].hides(pixel, margin);
  }
  /// For one thread.
  BlockFrame frame() const { return {map.crs, middle}; }
};

/// The files of a folder of photographs that may be images of the table, without what lies beside them (world files, metadata).
std::vector<std::filesystem::path> photographs_in(const std::filesystem::path& folder);

/// Throws core::Error with file and line: a column missing, a camera that is not there or states no pixels, an image that is there twice or
/// has two files, a rotation whose matrix and angles differ, cameras that all look up, a file of another size than the camera's, no image
/// with a file, heights of table and map that have no relation.
OrientedImages read_oriented_images(const std::vector<PhotoSource>& sources, const MetreMap& map);

}  // namespace swath::calib
