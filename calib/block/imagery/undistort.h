// SPDX-License-Identifier: GPL-3.0-or-later
// Images as a camera without distortion and with its principal point in the middle would have taken them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "calib/block/block_config.h"
#include "io/raster/image_raster.h"

namespace swath::calib {

/// The [[camera]] tables of a file such as camera.toml, of `swath block` or of a run; other keys are faults.
std::vector<CameraConfig> read_cameras(const std::filesystem::path& file);

/// Same size, principal distance and pixels; what the image does not show is 0. Bilinear. `name` stands in errors: core::Error where the
/// camera states no pixels, or other columns and rows than the image has.
io::ImageRaster undistorted(const io::ImageRaster& image, const CameraConfig& camera, const std::string& name);

/// The camera of undistorted images, as a [[camera]] table.
std::string undistorted_camera(const CameraConfig& camera);

}  // namespace swath::calib
