// SPDX-License-Identifier: GPL-3.0-or-later
// The engine: survey stages, then strips streamed into the tile store, then tile stages with halos, then merges.
#pragma once

#include "core/error.h"
#include "pipeline/engine/share.h"
#include "pipeline/plan.h"
#include "pipeline/progress.h"
#include "pipeline/provenance.h"

namespace swath::pipeline {

struct Outcome {
  core::Exit code = core::Exit::done;
  core::Value report;  ///< what report.json holds
};

/// Runs the plan, or continues where a killed run stopped. Throws core::Error; then nothing half-written stays.
Outcome run(Plan& plan, Progress& progress, const std::string& command);

/// Does one process's share of a wave, which stays in the work folder; what is done is not done again, and the share may be done by two
/// processes at once. The last wave is a run(). `inputs`: of the plan, where they are known; otherwise their files are read. Throws
/// core::Error, usage where the wave before is not done; then what other shares have done stays.
Outcome run_share(Plan& plan, Progress& progress, const std::string& command, const Share& share, std::vector<Input> inputs = {});

}  // namespace swath::pipeline
