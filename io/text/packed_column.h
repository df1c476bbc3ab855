// SPDX-License-Identifier: GPL-3.0-or-later
// A column of a chunk in few bytes, to the last bit: bytes of equal place in their values are put together and compressed (zstd, level 1).
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace swath::io {

/// The head of a packed column in a file.
struct PackedHead {
  std::uint32_t way = 0;    ///< how it was packed
  std::uint32_t bytes = 0;  ///< behind the head
};

/// Appends head and bytes of `n` values of `width` bytes each (1, 2, 4 or 8: numbers, of which differences may be smaller; others: rows).
void pack(const void* values, size_t n, size_t width, std::string& out);

/// The same of coordinates. Those that are decimals with at most five places, as files have them, take the fewest.
void pack_coordinates(const double* values, size_t n, std::string& out);

/// Widths of the fields (1, 2, 4 or 8 bytes, one after the other) by which rows take the fewest bytes, found with the first of them;
/// nothing where they are too few or too wide.
std::vector<std::uint8_t> fields_of_rows(const std::uint8_t* rows, size_t n, size_t width);

/// As pack(), of rows by their fields, each in the way that is smaller for it; by none where they do not add up to `width`.
void pack_rows(const std::uint8_t* rows, size_t n, size_t width, const std::vector<std::uint8_t>& fields, std::string& out);

/// The values back; false where the bytes are not what pack() gave for so many.
[[nodiscard]] bool unpack(const PackedHead& head, const char* bytes, void* values, size_t n, size_t width);

}  // namespace swath::io
