// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>

#include "stages/stage.h"

namespace swath::pipeline {

/// Processor time that a stage is expected to take for a return in strips, tiles or the merge, s: a rough guess, which serves the time left
/// of a run, corrected by how long the steps before took, and the cost of tasks. 0 for survey stages.
double expected_seconds(std::string_view stage, stages::Grain grain);

/// Processor time for a return of what no stage is charged with: the store of points, checksums, delivery; s.
double expected_overhead();

/// Records of a whole survey.
struct SurveyRecords {
  double returns = 0.0, imu = 0.0;
};

/// Processor time that a stage is expected to take once for the survey, s. 0 for one that is not listed, or works otherwise.
double expected_survey_seconds(std::string_view stage, const SurveyRecords& records);

}  // namespace swath::pipeline
