// SPDX-License-Identifier: GPL-3.0-or-later
// Records that share one time: the same written twice, or two devices in one file.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

namespace swath::io {

/// Records whose time is that of a record before them in the file, each with the first record of that time: (first, repeated) as indices,
/// by the repeated one. Times that are not finite are equal to none.
std::vector<std::pair<size_t, size_t>> repeated_times(const std::vector<double>& time);

}  // namespace swath::io
