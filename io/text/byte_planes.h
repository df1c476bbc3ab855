// SPDX-License-Identifier: GPL-3.0-or-later
// Values of several bytes as planes: the first bytes of all, then the second ones, and so on.
#pragma once

#include <cstddef>
#include <cstdint>

namespace swath::io {

/// `n` values of `width` bytes, one after the other, to `width` planes of `n` bytes. Values of 2, 4 and 8 bytes are aligned as numbers.
void to_planes(const std::uint8_t* values, std::size_t n, std::size_t width, std::uint8_t* planes);

/// The reverse of to_planes().
void from_planes(const std::uint8_t* planes, std::size_t n, std::size_t width, std::uint8_t* values);

}  // namespace swath::io
