// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>

#include "stages/stage.h"

namespace swath::pipeline {

/// Processor time that a stage is expected to take for a return in strips, tiles or the merge, s: a rough guess, which serves the time left
/// of a run alone and is corrected by how long the steps before took. 0 for survey stages, whose time does not go with the returns.
double expected_seconds(std::string_view stage, stages::Grain grain);

}  // namespace swath::pipeline
