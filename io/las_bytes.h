// SPDX-License-Identifier: GPL-3.0-or-later
// Little-endian numbers at any address, as LAS files hold them.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>

namespace swath::io::las {

static_assert(std::endian::native == std::endian::little, "LAS is little-endian; a big-endian machine needs swaps here");

template <class T>
T get(const std::uint8_t* at) {
  T v;
  std::memcpy(&v, at, sizeof v);
  return v;
}

template <class T>
void put(std::uint8_t* at, T v) {
  std::memcpy(at, &v, sizeof v);
}

}  // namespace swath::io::las
