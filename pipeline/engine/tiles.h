// SPDX-License-Identifier: GPL-3.0-or-later
// The tiles of a run: every tile stage on groups of tiles, in parallel within the memory budget, and the merges.
#pragma once

#include "pipeline/engine/run_state.h"

namespace swath::pipeline {

/// Every tile stage has a way to work on every tile that is not done; otherwise the one that takes most is named.
void expect_room_for_tiles(RunState& run);

void run_tile_stages(RunState& run);

/// The last stage whose tiles depend on points; that of the strips where none does.
size_t last_reader(const RunState& run);
bool is_tile_done(const RunState& run, size_t number, TileKey key);

}  // namespace swath::pipeline
