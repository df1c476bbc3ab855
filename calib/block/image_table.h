// SPDX-License-Identifier: GPL-3.0-or-later
// The tables of a block's config: images with stations and angles, surveyed points.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "calib/block/block_config.h"
#include "calib/block/image_block.h"

namespace swath::calib {

/// One row of the table of images; its position is not set.
struct ImageRow {
  BlockImage image;
  Eigen::Vector3d map = Eigen::Vector3d::Zero();  ///< of the station
  double sigma_h = 0.0, sigma_v = 0.0;            ///< m
  std::array<double, 3> angles{};                 ///< rad
};

/// A point of a control file.
struct SurveyedPoint {
  std::string name;
  Eigen::Vector3d map = Eigen::Vector3d::Zero();
  double sigma_h = 0.0, sigma_v = 0.0;  ///< m
  io::ControlKind kind = io::ControlKind::xyz;
  bool check = false;
  std::string place;  ///< "file:line"
};

/// Number of a camera of the config. Throws core::Error where it is not there.
std::uint32_t camera_number(const BlockConfig& config, const std::string& name, const std::string& place);

/// Throws core::Error with file and line: a column missing, an image that is there twice, a camera that is not in the config, a sigma that
/// is not above 0.
std::vector<ImageRow> read_image_table(const BlockConfig& config);
std::vector<SurveyedPoint> read_control_tables(const BlockConfig& config);

}  // namespace swath::calib
