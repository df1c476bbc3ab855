// SPDX-License-Identifier: GPL-3.0-or-later
// Surveyed control as the calibration uses it: planes and points in the local frame.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "calib/ties/tie_set.h"
#include "core/report.h"
#include "io/vector/control.h"
#include "trajectory/fix_window.h"

namespace swath::calib {

/// A surveyed plane with its corners, or a single point on the ground.
struct SurveyedTarget {
  std::string name;
  std::vector<Eigen::Vector3d> corners;               ///< local frame, m, in their order around the plane: its outline
  std::vector<PlaneControl> control;                  ///< one per corner, sigma along the plane's normal
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();   ///< weighted mean of the corners
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< unit, upwards; of a point: up
  bool is_point = false;
  double sigma_h = 0.0;  ///< of a point: of each horizontal coordinate, which counts where the ground slopes, m
  io::ControlUse use = io::ControlUse::control;
};

/// Sigma along a unit direction of a point whose horizontal coordinates have sigma_h each and whose height has sigma_v, m.
double sigma_along(const Eigen::Vector3d& direction, double sigma_h, double sigma_v);

/// The plane through corners, their weights from sigma_h and sigma_v along its normal (least squares of the distances), and how far each
/// corner is from it.
struct CornerPlane {
  Eigen::Vector3d centre, normal;  ///< normal unit, upwards
  std::vector<double> sigma;       ///< of each corner along the normal, m
  std::vector<double> residual;    ///< distance from the plane, positive on the normal's side, m
  std::vector<double> redundancy;  ///< of each corner, 0 to 1; their sum is the number of corners less three
};
/// Three corners or more, not in one line; sizes of all three agree.
CornerPlane corner_plane(const std::vector<Eigen::Vector3d>& corners, const std::vector<double>& sigma_h,
                         const std::vector<double>& sigma_v);

/// Planes and points of read_control() in the local frame, in its order. Counted in the tally, with the corner and its distance: targets
/// of which a corner lies off the plane of the others by more than four sigmas of that distance (the corner is kept), and those whose
/// outline crosses itself.
std::vector<SurveyedTarget> surveyed_targets(const std::vector<io::ControlPoint>& points, const trajectory::LocalFrame& frame,
                                             core::Tally& tally);

}  // namespace swath::calib
