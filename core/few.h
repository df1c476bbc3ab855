// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

namespace swath::core {

/// So many of a file's records may be left out as impossible (at most `max_share` of all, or 3 of at least 10); where there are more, the
/// file is not what the survey says of it.
inline bool are_few(std::uint64_t left_out, std::uint64_t records, double max_share = 0.03) {
  constexpr std::uint64_t always_few = 3;  // of at least `min_records`
  constexpr std::uint64_t min_records = 10;
  if (static_cast<double>(left_out) <= max_share * static_cast<double>(records)) return true;
  return left_out <= always_few && records >= min_records;
}

}  // namespace swath::core
