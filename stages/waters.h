// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "stages/stage.h"

namespace swath::stages {

/// Around each lake and river whose heights terrain.breaklines knows (map frame, m): where the terrain model has cells, points or not.
/// Empty where the plan has no such stage.
std::vector<Box> waters_of(const Context& context);

}  // namespace swath::stages
