// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/config/value.h"
#include "simulate/options.h"

namespace swath::simulate {

/// A calibration flight of full size over the airfield: tactical IMU, 700 and 1100 m, boresight (evenly within 0.5 deg), range offset and
/// scan scale drawn by the seed and delivered uncalibrated, the roof in the middle surveyed.
Options calibration_flight();

/// The zoo for ground filters, 600 m by 400 m from 500 m: two lines, some 4 pulses per square metre, outliers of every kind; no IMU and
/// GNSS records.
Options zoo_survey();

/// Options as a config gives them. What it leaves out has the defaults, which for flight.pattern = "calibration" are those of
/// calibration_flight(), and otherwise for world.scene = "zoo" those of zoo_survey(). Throws Error with all faults.
Options read_options(const core::Value& given);

/// Default options of a preset: the zoo's scenes small (some 20 000 returns), for tests; `mixed` as the full default survey; `airfield` a
/// small calibration flight at 300 m (some 700 000 returns); `zoo` with a tenth of its pulses.
Options preset(Scene scene);

}  // namespace swath::simulate
