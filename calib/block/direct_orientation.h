// SPDX-License-Identifier: GPL-3.0-or-later
// Direct orientation: the pose of each image from the trajectory at its exposure, the camera's lever arm and boresight.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "calib/block/navigation/exposures.h"
#include "calib/block/navigation/orientation_correlation.h"
#include "calib/block/orientation_table.h"
#include "core/config/option.h"
#include "core/config/result.h"
#include "core/geo/crs.h"
#include "trajectory/ins/error_model.h"
#include "trajectory/trajectory.h"

namespace swath::calib {

struct DirectOptions {
  int correlated_images = 10;
  trajectory::ErrorModelOptions errors;
};

template <class V>
void describe(DirectOptions& o, V& v) {
  v.option("correlated_images", o.correlated_images, core::within(0, 1000),
           "Images before each one that its errors are paired with; 0: no file of them.");
  v.table("errors", o.errors, "Errors of trajectories that state no covariances between instants.");
}

/// A camera on the carrier. Sigmas are common to all images, of each component; 0 where they are not known.
struct DirectCamera {
  std::string name;
  Eigen::Matrix3d body_R_camera = Eigen::Matrix3d::Identity();
  Eigen::Vector3d lever_arm = Eigen::Vector3d::Zero();  ///< body, IMU centre to perspective centre, m
  double sigma_boresight = 0.0, sigma_lever_arm = 0.0;  ///< rad, m
};

/// Throws core::Error for a sigma that is none of "held", "free" and a number.
DirectCamera direct_camera(const io::SurveyCamera& camera, const std::string& survey);

/// How the errors of a perspective centre on the grid and of the body's rotation come about (axes of OrientationCorrelation).
struct DirectErrors {
  PoseCovariance by_pose = PoseCovariance::Zero();                            ///< by north, east, down, roll, pitch, heading
  Eigen::Matrix<double, 6, 1> of_time = Eigen::Matrix<double, 6, 1>::Zero();  ///< one sigma of the event's own time
};

struct DirectImage {
  std::string name;
  std::uint32_t camera = 0;
  int strip = 0;
  double time = 0.0;  ///< GPS time, s
  bool doubtful = false;
  std::optional<size_t> event{};  ///< as Exposure
  ImageOrientation orientation;
  core::Attitude attitude;  ///< of the body, from true north
  DirectErrors errors;
};

struct DirectFound {
  size_t events = 0, unnamed = 0, outside = 0, doubtful = 0, exact = 0, images = 0;
  double position = 0.0, height = 0.0, angle = 0.0, heading = 0.0;  ///< median sigmas, m and rad
  std::vector<std::string> without;
};
template <class V>
void describe(const DirectFound& r, V& v) {
  v.result("events", r.events, "Exposures.");
  v.result("events_without_image", r.unnamed, core::if_any(), "Events that no list of images names.");
  v.result("images", r.images, core::plain().in_summary(), "Images with an orientation.");
  v.result("outside", r.outside, core::plain().in_summary(), "Exposures outside the trajectory.");
  v.result("doubtful", r.doubtful, "Exposures whose time is doubtful.");
  v.result("without_sigma", r.exact, core::if_any(), "Exposures without a stated sigma of time: their time counts as exact.");
  v.result("sigma_plan_m", r.position, core::metres(4).in_summary(), "Median standard deviation of easting and northing.");
  v.result("sigma_height_m", r.height, core::metres(4).in_summary(), "Median standard deviation of heights.");
  v.result("sigma_tilt_deg", r.angle / core::degree, core::in_degrees(5).in_summary(),
           "Median standard deviation of the tilt about the image's axes.");
  v.result("sigma_turn_deg", r.heading / core::degree, core::in_degrees(5).in_summary(), "The same about the camera's axis.");
  v.result("without", r.without, core::plain().in_summary().only_if(!r.without.empty()),
           "What these sigmas and those of the tables do not hold, being free: a camera's boresight, its lever arm.");
}

/// The images in the order of time. Covariance: the trajectory's (exact where the smoother gave it, else its sigmas as independent), the
/// time of the event by velocity and rotation, lever arm and boresight. Throws core::Error where no exposure is within the trajectory.
std::vector<DirectImage> direct_orientation(const trajectory::Trajectory& trajectory, const std::vector<Exposure>& exposures,
                                            const std::vector<DirectCamera>& cameras, const core::Crs& crs, DirectFound& found);

/// Covariances of each image with those before it, some of them: of the trajectory and each event's time, which images of one event share.
/// Lever arm and boresight, the same in all images, are not in them: an error that never decays is not a chain of few images; a block has
/// it as an unknown of the camera.
void direct_correlation(const std::vector<DirectImage>& images, const trajectory::Trajectory& trajectory, const DirectOptions& options,
                        const std::function<void(const CovariancePair&)>& take);

/// The table that [images] of `swath block` takes: stations are the perspective centres, angles those of the body.
std::string direct_images_csv(const std::vector<DirectImage>& images, const std::vector<DirectCamera>& cameras);

}  // namespace swath::calib
