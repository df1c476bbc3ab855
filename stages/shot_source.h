// SPDX-License-Identifier: GPL-3.0-or-later
// The raw returns of a plan's source, for stages that look at the whole flight before any strip is worked on.
#pragma once

#include "georef/shot_stream.h"
#include "stages/stage.h"

namespace swath::stages {

/// Streams the shots of context.source in the order of context.strips: line after line. Each batch is read while the one before it is
/// worked on. The stream must not outlive the context. Throws core::Error (usage) where the plan has no source of raw shots.
georef::ShotStream stream_shots(const Context& context);

}  // namespace swath::stages
