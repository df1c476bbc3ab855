// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "stages/stage.h"
#include "terrain/breaklines.h"

namespace swath::stages {

/// The breaklines that terrain.breaklines has settled, ready for any tile; null where the plan has no such stage.
std::unique_ptr<terrain::Breaklines> settled_breaklines(const Context& context);

}  // namespace swath::stages
