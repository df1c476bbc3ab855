// SPDX-License-Identifier: GPL-3.0-or-later
// From a config and its files to a block with start values.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "calib/block/block_config.h"
#include "calib/block/block_frame.h"
#include "calib/block/image_block.h"
#include "calib/block/image_table.h"
#include "calib/block/navigation/orientation_correlation.h"

namespace swath::calib {

/// The angles of an image as its table has them, rad.
struct StatedAngles {
  std::uint32_t image = 0;
  std::array<double, 3> value{};
};

/// A control point as its table has it.
struct StatedControl {
  Eigen::Vector3d map = Eigen::Vector3d::Zero();
  std::string place;  ///< "file:line"
};

struct ReadBlock {
  ImageBlock block;
  BlockFrame frame{"local", Eigen::Vector3d::Zero()};
  std::vector<StatedAngles> angles;
  std::vector<PoseCovariance> covariance;  ///< per image, where the config names a file of correlations
  std::vector<StatedControl> control;      ///< by number, as block.control
  std::vector<std::string> control_without_image;
  std::vector<std::string> images_without_points;
  size_t stations_observed = 0;
  std::string started_from;    ///< in words
  bool started_level = false;  ///< no angles, no orientations of a file
};

/// Throws core::Error: what a file lacks, names that are not there or are there twice, a point that is twice on an image, an image without
/// points or of another size than its camera's, drift without stations.
ReadBlock read_block(const BlockConfig& config, const std::string& config_file);
/// The same with these points in place of the config's; that none of them is on an image is no error.
ReadBlock read_block(const BlockConfig& config, const std::string& config_file, const std::vector<SurveyedPoint>& control);

/// local_R_body by angles of a kind at an image's position.
Eigen::Matrix3d body_attitude(const ReadBlock& read, std::uint32_t image, const std::array<double, 3>& angles, ImageAngles kind,
                              ImageNorth north);

/// Poses from stations, angles and the flight, points by intersection.
void start_block(ReadBlock& read, const BlockConfig& config);

}  // namespace swath::calib
