// SPDX-License-Identifier: GPL-3.0-or-later
// The engine: survey stages, then strips streamed into the tile store, then tile stages with halos, then merges.
#pragma once

#include "core/error.h"
#include "pipeline/plan.h"
#include "pipeline/progress.h"

namespace swath::pipeline {

struct Outcome {
  core::Exit code = core::Exit::done;
  core::Value report;  ///< what report.json holds
};

/// Runs the plan, or continues where a killed run stopped. Throws core::Error; then nothing half-written stays.
Outcome run(Plan& plan, Progress& progress, const std::string& command);

}  // namespace swath::pipeline
