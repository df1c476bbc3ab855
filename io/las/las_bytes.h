// SPDX-License-Identifier: GPL-3.0-or-later
// Little-endian numbers at any address, as LAS files hold them.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <string>

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

/// Text of a field of n bytes, up to the first 0.
inline std::string text_of(const std::uint8_t* at, std::size_t n) {
  const auto* end = std::find(at, at + n, std::uint8_t{0});
  return {at, end};
}

inline void put_text(std::uint8_t* at, std::size_t n, const std::string& text) { std::memcpy(at, text.data(), std::min(n, text.size())); }

}  // namespace swath::io::las
