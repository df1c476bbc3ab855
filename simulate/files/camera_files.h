// SPDX-License-Identifier: GPL-3.0-or-later
// Image points of the scene by a camera on the flight, with everything that `swath block` reads.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <optional>

#include "core/time.h"
#include "simulate/camera_options.h"
#include "simulate/files/events.h"
#include "simulate/flight.h"
#include "simulate/options.h"
#include "simulate/world/map_patch.h"
#include "simulate/world/world.h"

namespace swath::simulate {

struct CameraMade {
  std::uint64_t images = 0, points = 0, image_points = 0, hidden = 0;
  bool has_control = false, has_check = false;  ///< points on images
};

/// Writes images.csv (stations of the antenna with their errors, observed attitudes), image_points.csv, block_control.csv, block_check.csv,
/// block.toml, and truth/images.csv, truth/camera_points.csv, truth/drift.csv. Points that terrain, buildings or dense crowns hide are not
/// measured. Noise-free: no noise, shifts and drifts stay. Throws core::Error where no image sees a point.
CameraMade write_camera(const std::filesystem::path& folder, const World& world, const MapPatch& map, const Flight& flight,
                        core::GpsTime start, const Options& options);

}  // namespace swath::simulate
