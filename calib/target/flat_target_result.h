// SPDX-License-Identifier: GPL-3.0-or-later
// What the analysis of a calibration flight over a flat roof finds.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "calib/target/target_readings.h"
#include "calib/terms.h"
#include "core/records/sensor.h"

namespace swath::calib {

/// One angle, with everything that led to its new value. rad.
struct TargetAngle {
  Parameter parameter = boresight_roll;
  bool determined = false;
  double present = 0.0;           ///< in force before
  std::vector<Reading> readings;  ///< `value`: the boresight angle that the reading speaks for
  double mean = 0.0, own = 0.0, scatter = 0.0, sigma = 0.0;
  double tolerance = 0.0;
  bool beyond = false;          ///< mean and present differ by more than the tolerance
  double value = 0.0;           ///< new value: the mean where `beyond`, else the present one
  bool of_two_heights = false;  ///< the mean is that of angle and lever arm distinguished by two flying heights
};

/// One line's part.
struct TargetLine {
  int line = 0;
  std::uint32_t kept_one_in = 1;
  TargetView before, after;  ///< with the calibration in force, and with what was found
  bool measured = false;     ///< seen, and part of the readings
  TargetRole role = TargetRole::nadir;
  Eigen::Vector3d target{0, 0, 0};  ///< from scanner to target, body: forward, right, down, m
  double scan_angle = 0.0;          ///< under which the target's centre is seen, rad
  /// Of `before`, along, across, up: with trajectory, survey and calibration values held. Of an unsurveyed roof: relative to all lines.
  Eigen::Vector3d sigma{0, 0, 0};
};

struct FlatTarget {
  bool done = false;  ///< the target was found and seen
  RoofTarget target;
  std::vector<TargetLine> lines;
  TargetAngle roll, pitch, heading;
  bool range_determined = false;
  double range_present = 0.0, range_mean = 0.0, range_sigma = 0.0;  ///< range offset, m
  std::vector<Reading> range_readings;                              ///< `value`: range offset, m
  JointTarget joint;                                                ///< of the last round: what is left, all parameters at once
  double scan_scale = 1.0, scan_scale_sigma = 0.0;                  ///< by widths and places of the target
  core::Calibration calibration;                                    ///< new values where beyond the tolerance
  core::Calibration measured;                                       ///< the mean readings themselves
  std::vector<std::string> findings;                                ///< what is not determined or looks wrong, and what to do
  std::vector<std::string> notes;                                   ///< what is right, or was allowed for
  int rounds = 0;
  std::uint64_t returns = 0;
};

}  // namespace swath::calib
