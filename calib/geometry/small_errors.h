// SPDX-License-Identifier: GPL-3.0-or-later
// What the differences of lines on smooth ground, and of ground from control, say of small errors of calibration: least squares in which
// each pass may be off by what its trajectory's sigmas allow.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/geometry/geometry_pairs.h"
#include "calib/geometry/geometry_sample.h"
#include "calib/terms.h"
#include "core/records/sensor.h"
#include "georef/shot_geometry.h"
#include "trajectory/trajectory.h"

namespace swath::calib {

/// Errors of boresight_roll .. latency, in that order.
constexpr int small_count = latency + 1;
using SmallVector = Eigen::Matrix<double, small_count, 1>;
using SmallMatrix = Eigen::Matrix<double, small_count, small_count>;

/// The cells that two passes share, as lines are judged by them.
struct PairCells {
  size_t a = 0, b = 0;  ///< numbers in the grounds
  std::vector<SharedCell> shared;
};

/// A cell of a pass beside a surveyed height.
struct ControlCell {
  size_t ground = 0;  ///< number in the grounds
  const GroundCell* cell = nullptr;
  double apart = 0.0;  ///< height of the cell's plane at the point less the point's, m
  double sigma = 0.0;  ///< of the point's height and, where the ground slopes, of its place, m
  size_t point = 0;    ///< number of the point
};

/// Normal equations of the calibration's errors; those of the passes are eliminated.
struct SmallErrors {
  SmallMatrix normal = SmallMatrix::Zero();
  SmallVector right = SmallVector::Zero();
  double squares = 0.0;  ///< weighted, with no error of calibration
  size_t differences = 0;
  SmallMatrix prior = SmallMatrix::Zero();  ///< covariance of the calibration's values as stated, none smaller than what is always there

  struct Solution {
    SmallVector error = SmallVector::Zero();
    SmallVector sigma = SmallVector::Zero();
    double squares = 0.0;
  };
  /// With the values off by `known`, give or take their sigmas; those in `free` are found.
  Solution with(const SmallVector& known, const std::vector<Parameter>& free = {}) const;
};

struct SmallErrorsInput {
  const GeometrySample& sample;
  const std::vector<PassGround>& ground;
  const std::vector<PairCells>& pairs;
  const std::vector<ControlCell>& control;
  const ShotGeometry& geometry;
  const core::SensorSigma& sensor;
  const trajectory::Trajectory& trajectory;
  const trajectory::LocalFrame& frame;
};

SmallErrors small_errors(const SmallErrorsInput& input);

}  // namespace swath::calib
