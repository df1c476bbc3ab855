// SPDX-License-Identifier: GPL-3.0-or-later
// The raw returns of a flight as calibration sees them: read line by line, as often as needed.
#pragma once

#include <functional>

#include "core/shot.h"

namespace swath::georef {

/// Calls the function with batches of the raw returns, flight line after flight line (core::Shots is of one line, in the order of its
/// records; a line may come in several batches, and from several files). Every call reads the same returns in the same order.
using ShotStream = std::function<void(const std::function<void(int line, const core::Shots&)>&)>;

}  // namespace swath::georef
