// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

namespace swath::core {

/// a / b rounded down, b > 0: -1 / 4 is -1.
constexpr std::int64_t floor_div(std::int64_t a, std::int64_t b) { return a >= 0 ? a / b : -((-a + b - 1) / b); }

/// v rounded down, |v| < 2^63: as std::floor, which is a call on processors of the common baseline.
inline std::int64_t floor_of(double v) {
  const auto cut = static_cast<std::int64_t>(v);
  return cut - (static_cast<double>(cut) > v ? 1 : 0);
}

}  // namespace swath::core
