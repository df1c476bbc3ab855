// SPDX-License-Identifier: GPL-3.0-or-later
// Units in which the calibration's texts, tables and figures state angles and lengths.
#pragma once

#include "core/config/units.h"

namespace swath::calib {

constexpr double arc_second = core::degree / 3600.0, centimetre = 0.01, millimetre = 0.001;

}  // namespace swath::calib
