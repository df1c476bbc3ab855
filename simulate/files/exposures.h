// SPDX-License-Identifier: GPL-3.0-or-later
// Where the camera is at each event, and how a pixel looks at the world. The projection is this room's own.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/geo/frames.h"
#include "simulate/camera_options.h"
#include "simulate/flight.h"
#include "simulate/options.h"
#include "simulate/world/map_patch.h"

namespace swath::simulate {

struct CameraExposure {
  int id = 0, line = 0;
  double t = 0.0;  ///< s from the start of the flight
  core::Attitude attitude;
  Eigen::Vector3d centre, antenna;  ///< ecef
  Eigen::Matrix3d ecef_R_body, ecef_R_camera;
  Eigen::Vector3d on_map;  ///< the centre, as World
};

/// The flight's events, with the true mounting of the camera.
std::vector<CameraExposure> camera_exposures(const Flight& flight, const MapPatch& map, const Options& options);

/// Where a point in camera axes (x right, y up, z backward) is seen, mm from the middle of the sensor, y up; nothing beyond the sensor or
/// behind the camera.
std::optional<Eigen::Vector2d> seen_at(const CameraOptions& camera, const Eigen::Vector3d& direction);

/// The direction, in camera axes, that is seen at a place on the sensor, mm. Within a thousandth of a pixel.
Eigen::Vector3d seen_from(const CameraOptions& camera, const Eigen::Vector2d& at);

}  // namespace swath::simulate
