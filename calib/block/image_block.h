// SPDX-License-Identifier: GPL-3.0-or-later
// A block of images: what is observed and the values it starts from. Local frame: Cartesian, z up, metres; image plane in mm.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "calib/block/brown.h"
#include "core/config/option.h"

namespace swath::calib {

/// Sigma of a value that is not known at all, and of one that is held.
inline constexpr double free_value = std::numeric_limits<double>::infinity();
inline constexpr double held_value = 0.0;

struct BlockCamera {
  std::string name;
  CameraVector value = CameraVector::Zero();
  CameraVector sigma = CameraVector::Zero();  ///< of each value: held_value, free_value, or observed with that sigma
  DistortionAt distortion = DistortionAt::ideal;
  Eigen::Matrix3d body_R_camera = Eigen::Matrix3d::Identity();
  Eigen::Vector3d boresight_sigma = Eigen::Vector3d::Zero();  ///< rad, about the camera's axes: as `sigma`
  Eigen::Vector3d antenna = Eigen::Vector3d::Zero();          ///< from the perspective centre to what the station is of; camera axes, m
  Eigen::Vector3d antenna_sigma = Eigen::Vector3d::Zero();    ///< m, as `sigma`
};

struct BlockImage {
  std::string name;
  std::uint32_t camera = 0;
  int strip = 0;
  double time = 0.0;                                   ///< s; any scale that is one for the block
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< perspective centre, local, m
  Eigen::Matrix3d camera_R_local = Eigen::Matrix3d::Identity();
};

struct BlockPoint {
  std::string name;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< local, m
  bool left_out = false;                               ///< by the adjustment: its rays are parallel
};

/// One measured image point.
struct ImageRay {
  std::uint32_t image = 0, point = 0;
  double x = 0.0, y = 0.0;  ///< mm
  double sigma = 0.01;      ///< mm, of each coordinate
};

/// The position of an antenna (or of the perspective centre, with a zero lever arm) at an exposure.
struct ImageStation {
  std::uint32_t image = 0;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();        ///< local, m
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();  ///< m^2
};

/// The attitude of the body at an exposure.
struct ImageAttitude {
  std::uint32_t image = 0;
  Eigen::Matrix3d local_R_body = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();  ///< rad^2, of a rotation about the body's axes
};

/// The errors of an image's station (local frame, m) and attitude (about the camera's nominal axes, rad), one of them or both, given those
/// of images before it: e = by_before e_before + q, Cov(q) = root root'.
struct NavigationStep {
  std::uint32_t image = 0;
  std::vector<std::uint32_t> before;  ///< images
  Eigen::MatrixXd by_before, root;    ///< root: lower triangle
};

/// A surveyed point. Check points take no part in the adjustment.
struct BlockControl {
  std::uint32_t point = 0;
  bool check = false;
  std::array<bool, 3> known{true, true, true};                                          ///< x, y, z
  Eigen::Vector3d position = Eigen::Vector3d::Zero(), sigma = Eigen::Vector3d::Ones();  ///< local, m
};

/// Unknown shift and drift of the stations (Ackermann, eq 1): none, one set for the block, or one per strip.
enum class DriftSets { none, block, strip };

/// One set: X_GPS + v = X0 + a0 + a1 u, u = (t - first) / span.
struct StationDrift {
  int strip = 0;                                     ///< of DriftSets::strip
  double first = 0.0, span = 0.0;                    ///< s: time of the set's first station, and to its last
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();   ///< a0, m, at the first station
  Eigen::Vector3d change = Eigen::Vector3d::Zero();  ///< a1 times the span, m
};

/// Unknown datum of the stations against control: none, a shift, or shift, rotation and scale.
enum class Datum { none, shift, similarity };

/// X_GPS + v = centre + (1 + scale) exp(rotation) (X - centre) + shift, and attitudes are turned by exp(rotation).
struct StationDatum {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();                                     ///< local, m: held
  Eigen::Vector3d shift = Eigen::Vector3d::Zero(), rotation = Eigen::Vector3d::Zero();  ///< m, rad
  double scale = 0.0;
};

struct ImageBlock {
  std::vector<BlockCamera> cameras;
  std::vector<BlockImage> images;
  std::vector<BlockPoint> points;
  std::vector<ImageRay> rays;
  std::vector<ImageStation> stations;  ///< at most one per image
  std::vector<ImageAttitude> attitudes;
  std::vector<NavigationStep> chain;  ///< of all stations and attitudes; empty: those of different images are independent
  std::vector<BlockControl> control;
  DriftSets drift_sets = DriftSets::none;
  std::vector<StationDrift> drifts;  ///< made by find_drift_sets()
  std::vector<int> drift_of;         ///< per station: its set, or -1
  Datum datum = Datum::none;
  StationDatum station_datum;  ///< its centre is made by find_drift_sets()
};

}  // namespace swath::calib

namespace swath::core {
template <>
struct Choices<calib::DriftSets> {
  static constexpr std::array<std::string_view, 3> names{"none", "block", "strip"};
};
template <>
struct Choices<calib::Datum> {
  static constexpr std::array<std::string_view, 3> names{"none", "shift", "similarity"};
};
}  // namespace swath::core
