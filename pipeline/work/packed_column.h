// SPDX-License-Identifier: GPL-3.0-or-later
// A column of a chunk in few bytes, to the last bit: bytes of equal place in their values are put together and compressed (zstd, level 1).
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace swath::pipeline {

/// The head of a packed column in a file.
struct PackedHead {
  std::uint32_t way = 0;    ///< how it was packed
  std::uint32_t bytes = 0;  ///< behind the head
};

/// Appends head and bytes of `n` values of `width` bytes each (1, 2, 4 or 8: numbers, of which differences may be smaller; others: rows).
void pack(const void* values, size_t n, size_t width, std::string& out);

/// The same of coordinates. Those that are decimals with at most five places, as files have them, take the fewest.
void pack_coordinates(const double* values, size_t n, std::string& out);

/// The values back; false where the bytes are not what pack() gave for so many.
[[nodiscard]] bool unpack(const PackedHead& head, const char* bytes, void* values, size_t n, size_t width);

}  // namespace swath::pipeline
