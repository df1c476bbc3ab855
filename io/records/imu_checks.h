// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "core/records/imu_data.h"
#include "core/report.h"
#include "io/survey/navigation.h"

namespace swath::io {

/// Holds IMU data in `body` against what a vehicle feels that is level most of the time, by means over seconds and their medians over the
/// record. Throws Error with numbers and a hint where the units or axes cannot be those stated: specific force far from gravity
/// (g taken for m/s2, increments for rates ...), gravity along another axis than up, seconds of over 1 rad/s. Counts as warnings:
/// specific force more than a tenth from gravity, more than 20 deg from up, seconds of over 0.15 rad/s (degrees taken for radians?) and a
/// record that hardly turns at all (radians taken for degrees?). `step`: the nominal step, s.
void check_imu(const core::ImuData& imu, const ImuFile& file, double step, const std::string& name, core::Tally& tally);

}  // namespace swath::io
