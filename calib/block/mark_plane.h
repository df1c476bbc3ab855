// SPDX-License-Identifier: GPL-3.0-or-later
// Image points between pixels and the image plane (mm, y up, from the middle of the sensor), cameras between pixels and Brown's values.
#pragma once

#include <Eigen/Core>
#include <string>

#include "calib/block/block_config.h"
#include "calib/block/image_block.h"
#include "io/images/image_file.h"

namespace swath::calib {

/// Side of a pixel, m. Throws core::Error where the camera states none.
double pixel_side(const CameraConfig& camera, const std::string& file);
/// mm. Throws core::Error where the file is in pixels and the camera states no pixels.
Eigen::Vector2d on_plane(const io::ImageData& data, const io::ImageMark& mark, const CameraConfig& camera);

/// Pixels from the corner of the first pixel, y down.
Eigen::Vector2d in_pixels(const Eigen::Vector2d& plane, const CameraConfig& camera);
/// The camera as COLMAP knows it. Exact where the distortion is of the ideal point and b1 = b2 = 0; nothing otherwise.
std::optional<io::FileCamera> pixel_camera(const BlockCamera& camera, const CameraConfig& config);

}  // namespace swath::calib
