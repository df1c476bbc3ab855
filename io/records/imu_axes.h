// SPDX-License-Identifier: GPL-3.0-or-later
// Units and axes of an IMU's records.
#pragma once

#include <Eigen/Core>

#include "io/survey/navigation.h"

namespace swath::io {

/// m/s2 per unit; 0 where unstated.
double mps2_per(AccelerationUnit unit);

/// What takes vectors of the record's axes to `body`: the mounting rotation of the axes map. Throws Error where `axes` is no right-handed
/// set of x, y, z with signs.
Eigen::Matrix3d body_R_record(const ImuFile& file);

}  // namespace swath::io
