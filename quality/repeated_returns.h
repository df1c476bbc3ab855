// SPDX-License-Identifier: GPL-3.0-or-later
// First returns that a cloud holds twice, as tiles delivered with buffers do.
#pragma once

#include <cstdint>
#include <vector>

#include "core/block.h"

namespace swath::quality {

/// 1 for each usable first return that repeats another one, which keeps 0; of the block's length, empty where none does. Two are the same
/// where place (0.1 mm), GPS time and return number are; without times (0) also every other recorded column that the block has: in a cloud
/// of coarse scale several true returns share a place. The one of the lowest line and least coordinates is kept, whatever the order.
std::vector<std::uint8_t> repeated_first_returns(const core::Block& block);

}  // namespace swath::quality
