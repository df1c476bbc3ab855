// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "stages/tile.h"
#include "terrain/water/breaklines.h"

namespace swath::stages {

/// The breaklines that terrain.breaklines has settled, ready for any tile; null where the plan has no such stage.
const terrain::Breaklines* breaklines_of(const Context& context, RunCache& cache);

}  // namespace swath::stages
