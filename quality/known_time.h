// SPDX-License-Identifier: GPL-3.0-or-later
// Times of returns that clouds do not know.
#pragma once

#include <cmath>

#include "core/time.h"

namespace swath::quality {

/// False for what files without times hold: 0, which is 1e9 s where a file's times are adjusted standard GPS time.
inline bool is_known_time(double time) { return std::isfinite(time) && time != 0.0 && time != core::adjusted_offset; }

}  // namespace swath::quality
