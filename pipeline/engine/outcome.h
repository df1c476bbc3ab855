// SPDX-License-Identifier: GPL-3.0-or-later
// The end of a run: its report, the limits that it is judged by, and the delivery of its products.
#pragma once

#include "pipeline/engine/run_state.h"
#include "pipeline/work/time_spent.h"
#include "pipeline/work/work_folder.h"

namespace swath::pipeline {

/// What report.json holds. `command`: as it was typed; `time`: that the run took.
core::Value report_of(const RunState& run, const std::string& command, const TimeSpent& time);

/// All products go to the output folder, and the report behind them.
void deliver_all(RunState& run, const core::Value& report, const WorkLock& lock);
/// At the very end, when the work is discarded too.
void expect_all_delivered(const RunState& run, const core::Value& report);

/// What quality.geometry found; null where it did not run.
const core::Value* judged_geometry(const RunState& run);

/// A late stage failed: the products of those before it are whole and stay, with the work that the same command goes on from.
[[noreturn]] void keep_finished(const RunState& run, const core::Error& e);

}  // namespace swath::pipeline
