// SPDX-License-Identifier: GPL-3.0-or-later
// The strips of a run: the source's flight lines, each streamed through the strip stages into the store of points.
#pragma once

#include "pipeline/engine/run_state.h"

namespace swath::pipeline {

/// The strips' folder is named by the columns of its points, too: all of them, where the store is kept for other stages than these or an
/// earlier run has kept it so; otherwise those that are needed.
void choose_strips(RunState& run);

/// The source's strips, for the stages that stream its shots, too.
void find_strips(RunState& run);

/// Fills the store of points. Throws core::Error where no point comes out.
void run_strips(RunState& run);

}  // namespace swath::pipeline
