// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers are put together and taken apart by shifts, which the compiler turns into vector instructions.
#include "io/text/byte_planes.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "core/wide.h"

namespace swath::io {
namespace {

constexpr std::size_t rows_together = 256;
constexpr bool shifts_do = std::endian::native == std::endian::little;

SWATH_WIDE void join_2(const std::uint8_t* __restrict p, std::size_t n, std::uint16_t* __restrict out) {
  for (std::size_t i = 0; i < n; ++i) out[i] = static_cast<std::uint16_t>(p[i] | p[n + i] << 8);
}

SWATH_WIDE void join_4(const std::uint8_t* __restrict p, std::size_t n, std::uint32_t* __restrict out) {
  for (std::size_t i = 0; i < n; ++i)
    out[i] = std::uint32_t{p[i]} | std::uint32_t{p[n + i]} << 8 | std::uint32_t{p[2 * n + i]} << 16 | std::uint32_t{p[3 * n + i]} << 24;
}

SWATH_WIDE void join_8(const std::uint8_t* __restrict p, std::size_t n, std::uint64_t* __restrict out) {
  for (std::size_t i = 0; i < n; ++i) {
    const std::uint32_t low =
        std::uint32_t{p[i]} | std::uint32_t{p[n + i]} << 8 | std::uint32_t{p[2 * n + i]} << 16 | std::uint32_t{p[3 * n + i]} << 24;
    const std::uint32_t high = std::uint32_t{p[4 * n + i]} | std::uint32_t{p[5 * n + i]} << 8 | std::uint32_t{p[6 * n + i]} << 16 |
                               std::uint32_t{p[7 * n + i]} << 24;
    out[i] = std::uint64_t{low} | std::uint64_t{high} << 32;
  }
}

/// One plane after the other: values of a few rows stay in the nearest cache.
template <class T>
inline void split(const T* __restrict v, std::size_t n, std::uint8_t* __restrict planes) {
  for (std::size_t first = 0; first < n; first += rows_together) {
    const std::size_t last = std::min(n, first + rows_together);
    for (std::size_t k = 0; k < sizeof(T); ++k)
      for (std::size_t i = first; i < last; ++i) planes[k * n + i] = static_cast<std::uint8_t>(v[i] >> (8 * k));
  }
}
SWATH_WIDE void split_2(const std::uint16_t* v, std::size_t n, std::uint8_t* planes) { split(v, n, planes); }
SWATH_WIDE void split_4(const std::uint32_t* v, std::size_t n, std::uint8_t* planes) { split(v, n, planes); }
SWATH_WIDE void split_8(const std::uint64_t* v, std::size_t n, std::uint8_t* planes) { split(v, n, planes); }

/// Calls f(first, last) for rows that stay in the nearest cache: planes lie apart by powers of two, which fall on the same lines of it.
template <class F>
void by_rows(std::size_t n, F&& f) {
  for (std::size_t first = 0; first < n; first += rows_together) f(first, std::min(n, first + rows_together));
}

}  // namespace

void to_planes(const std::uint8_t* values, std::size_t n, std::size_t width, std::uint8_t* planes) {
  if (width == 1 && n > 0) std::memcpy(planes, values, n);
  if (width == 1) return;
  if (shifts_do && width == 2) return split_2(reinterpret_cast<const std::uint16_t*>(values), n, planes);
  if (shifts_do && width == 4) return split_4(reinterpret_cast<const std::uint32_t*>(values), n, planes);
  if (shifts_do && width == 8) return split_8(reinterpret_cast<const std::uint64_t*>(values), n, planes);
  by_rows(n, [=](std::size_t first, std::size_t last) {
    for (std::size_t k = 0; k < width; ++k)
      for (std::size_t i = first; i < last; ++i) planes[k * n + i] = values[i * width + k];
  });
}

void from_planes(const std::uint8_t* planes, std::size_t n, std::size_t width, std::uint8_t* values) {
  if (width == 1 && n > 0) std::memcpy(values, planes, n);
  if (width == 1) return;
  if (shifts_do && width == 2) return join_2(planes, n, reinterpret_cast<std::uint16_t*>(values));
  if (shifts_do && width == 4) return join_4(planes, n, reinterpret_cast<std::uint32_t*>(values));
  if (shifts_do && width == 8) return join_8(planes, n, reinterpret_cast<std::uint64_t*>(values));
  by_rows(n, [=](std::size_t first, std::size_t last) {
    for (std::size_t k = 0; k < width; ++k)
      for (std::size_t i = first; i < last; ++i) values[i * width + k] = planes[k * n + i];
  });
}

}  // namespace swath::io
