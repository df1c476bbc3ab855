// SPDX-License-Identifier: GPL-3.0-or-later
// The start of a run: what its map, its inputs and its stages are, and the stages that work once on the survey.
#pragma once

#include "pipeline/engine/run_state.h"

namespace swath::pipeline {

/// CRS, fingerprints and folders of the stages. `run.inputs` that are given are not read again. Throws core::Error (usage).
void prepare(RunState& run);

/// Runs the survey stages, or takes up what is done of them.
void run_survey_stages(RunState& run);

}  // namespace swath::pipeline
