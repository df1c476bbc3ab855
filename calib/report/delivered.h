// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "calib/adjust/adjustment.h"
#include "core/records/sensor.h"

namespace swath::calib {

/// What calibration.json delivers: the adjusted values, or the start values of parameters that a finding refuses; and their sigmas, those
/// of the sensor where nothing was estimated (lever arm: the largest of the three).
struct DeliveredCalibration {
  core::Calibration calibration;
  core::SensorSigma sigma;
};
DeliveredCalibration delivered(const calib::Adjustment& adjustment, const core::SensorSigma& sensor);

}  // namespace swath::calib
