// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>

#include "stages/stage.h"

namespace swath::pipeline {

/// Processor time that a stage is expected to take for a return, s: a rough guess, which serves the time left of a run, where it is
/// corrected by how long the steps before took, and what `swath tasks` states.
double expected_seconds(std::string_view stage, stages::Grain grain);

/// And for a record of the IMU, s: of stages that work on the survey as a whole.
double expected_seconds_of_imu_record(std::string_view stage);

}  // namespace swath::pipeline
