// SPDX-License-Identifier: GPL-3.0-or-later
// A decimal coordinate is the whole number of thousandths next to it, and the few last places of a double by which its file's own
// rounding differs from that.
#include "pipeline/work/packed_column.h"

#include <zstd.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <memory>
#include <type_traits>
#include <vector>

namespace swath::pipeline {
namespace {

constexpr int level = 1;
constexpr size_t rows_at_once = 256;
constexpr size_t sampled = 4096;  // values, for the choice of the way
constexpr double per_unit = 1000.0;

enum Way : std::uint32_t { plain, differences, decimals };

struct Codec {
  std::unique_ptr<ZSTD_CCtx, decltype(&ZSTD_freeCCtx)> pack{ZSTD_createCCtx(), &ZSTD_freeCCtx};
  std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> unpack{ZSTD_createDCtx(), &ZSTD_freeDCtx};
  std::vector<std::uint8_t> planes, packed;
};

Codec& codec() {
  thread_local Codec mine;
  return mine;
}

/// Calls f(width), a constant for the widths of numbers: loops over it are unrolled.
template <class F>
void with_width(size_t width, F&& f) {
  if (width == 1) return f(std::integral_constant<size_t, 1>());
  if (width == 2) return f(std::integral_constant<size_t, 2>());
  if (width == 4) return f(std::integral_constant<size_t, 4>());
  if (width == 8) return f(std::integral_constant<size_t, 8>());
  f(width);
}

/// Calls f(first, last) for rows that stay in the nearest cache: planes lie apart by powers of two, which fall on the same lines of it.
template <class F>
void by_rows(size_t n, F&& f) {
  for (size_t first = 0; first < n; first += rows_at_once) f(first, std::min(n, first + rows_at_once));
}

void to_planes(const std::uint8_t* from, size_t n, size_t row, std::uint8_t* to) {
  with_width(row, [=](auto width) {
    by_rows(n, [=](size_t first, size_t last) {
      for (size_t k = 0; k < width; ++k)
        for (size_t i = first; i < last; ++i) to[k * n + i] = from[i * width + k];
    });
  });
}

void from_planes(const std::uint8_t* from, size_t n, size_t row, std::uint8_t* to) {
  with_width(row, [=](auto width) {
    by_rows(n, [=](size_t first, size_t last) {
      for (size_t k = 0; k < width; ++k)
        for (size_t i = first; i < last; ++i) to[i * width + k] = from[k * n + i];
    });
  });
}

template <class T>
void difference(T* v, size_t n) {
  for (size_t i = n; i-- > 1;) v[i] = static_cast<T>(v[i] - v[i - 1]);
}

template <class T>
void add_up(T* v, size_t n) {
  for (size_t i = 1; i < n; ++i) v[i] = static_cast<T>(v[i] + v[i - 1]);
}

/// Calls f(pointer) with the bytes as numbers of their width.
template <class F>
void as_numbers(void* bytes, size_t width, F&& f) {
  if (width == 1) f(static_cast<std::uint8_t*>(bytes));
  if (width == 2) f(static_cast<std::uint16_t*>(bytes));
  if (width == 4) f(static_cast<std::uint32_t*>(bytes));
  if (width == 8) f(static_cast<std::uint64_t*>(bytes));
}

bool has_numbers(size_t width) { return width == 1 || width == 2 || width == 4 || width == 8; }

/// Compressed into codec().packed; its size.
size_t compress(const void* values, size_t n, size_t width, Way way) {
  Codec& c = codec();
  std::vector<std::uint64_t> own((n * width + 7) / 8);
  std::memcpy(own.data(), values, n * width);
  if (way == differences) as_numbers(own.data(), width, [n](auto* v) { difference(v, n); });
  c.planes.resize(n * width);
  to_planes(reinterpret_cast<const std::uint8_t*>(own.data()), n, width, c.planes.data());
  c.packed.resize(ZSTD_compressBound(c.planes.size()));
  const size_t size = ZSTD_compressCCtx(c.pack.get(), c.packed.data(), c.packed.size(), c.planes.data(), c.planes.size(), level);
  if (ZSTD_isError(size)) throw std::bad_alloc();  // with room enough nothing else fails
  return size;
}

void put_head(Way way, size_t bytes, std::string& out) {
  const PackedHead head{way, static_cast<std::uint32_t>(bytes)};
  out.append(reinterpret_cast<const char*>(&head), sizeof head);
}

void put(const void* values, size_t n, size_t width, Way way, std::string& out) {
  const size_t size = compress(values, n, width, way);
  put_head(way, size, out);
  out.append(reinterpret_cast<const char*>(codec().packed.data()), size);
}

Way smaller_way(const void* values, size_t n, size_t width) {
  if (!has_numbers(width) || n < 2) return plain;
  n = std::min(n, sampled);
  return compress(values, n, width, differences) < compress(values, n, width, plain) ? differences : plain;
}

double decimal(std::int64_t thousandths, std::int64_t last_places, double origin) {
  const auto bits = std::bit_cast<std::uint64_t>(static_cast<double>(thousandths) / per_unit);
  return std::bit_cast<double>(bits + static_cast<std::uint64_t>(last_places)) - origin;
}

bool inflate(const char* bytes, size_t size, void* values, size_t n, size_t width, bool summed) {
  if (ZSTD_getFrameContentSize(bytes, size) != n * width) return false;  // nor where the frame does not say
  Codec& c = codec();
  c.planes.resize(n * width);
  const size_t got = ZSTD_decompressDCtx(c.unpack.get(), c.planes.data(), c.planes.size(), bytes, size);
  if (ZSTD_isError(got) || got != n * width) return false;
  from_planes(c.planes.data(), n, width, static_cast<std::uint8_t*>(values));
  if (summed) as_numbers(values, width, [n](auto* v) { add_up(v, n); });
  return true;
}

}  // namespace

void pack(const void* values, size_t n, size_t width, std::string& out) { put(values, n, width, smaller_way(values, n, width), out); }

void pack_coordinates(const double* values, size_t n, double origin, std::string& out) {
  constexpr double most = 2e9;  // thousandths fit into 32 bits as differences from the first
  std::vector<std::int32_t> steps(n);
  std::vector<std::int8_t> places(n);
  std::int64_t first = 0;
  for (size_t i = 0; i < n; ++i) {
    const double v = values[i] + origin;
    if (!(std::abs(v) < 1e12)) return pack(values, n, 8, out);
    const std::int64_t thousandths = std::llround(v * per_unit);
    if (i == 0) first = thousandths;
    const std::int64_t rest = std::bit_cast<std::int64_t>(v) - std::bit_cast<std::int64_t>(static_cast<double>(thousandths) / per_unit);
    if (std::abs(static_cast<double>(thousandths - first)) > most || rest < -127 || rest > 127 ||
        std::bit_cast<std::int64_t>(decimal(thousandths, rest, origin)) != std::bit_cast<std::int64_t>(values[i]))
      return pack(values, n, 8, out);
    steps[i] = static_cast<std::int32_t>(thousandths - first);
    places[i] = static_cast<std::int8_t>(rest);
  }
  std::string parts(reinterpret_cast<const char*>(&first), sizeof first);
  pack(steps.data(), n, 4, parts);
  pack(places.data(), n, 1, parts);
  put_head(decimals, parts.size(), out);
  out += parts;
}

bool unpack(const PackedHead& head, const char* bytes, void* values, size_t n, size_t width, double origin) {
  if (head.way == plain || head.way == differences) return inflate(bytes, head.bytes, values, n, width, head.way == differences);
  if (head.way != decimals || width != 8) return false;
  std::int64_t first = 0;
  if (head.bytes < sizeof first) return false;
  std::memcpy(&first, bytes, sizeof first);
  std::vector<std::int32_t> steps(n);
  std::vector<std::int8_t> places(n);
  size_t at = sizeof first;
  const auto part = [&](void* to, size_t size) {
    PackedHead h;
    if (head.bytes - at < sizeof h) return false;
    std::memcpy(&h, bytes + at, sizeof h);
    at += sizeof h;
    if (h.way > differences || h.bytes > head.bytes - at || !inflate(bytes + at, h.bytes, to, n, size, h.way == differences)) return false;
    at += h.bytes;
    return true;
  };
  if (!part(steps.data(), 4) || !part(places.data(), 1) || at != head.bytes) return false;
  // Unsigned: numbers that nobody has written may not fit.
  const auto sum = [first](std::int32_t step) {
    return static_cast<std::int64_t>(static_cast<std::uint64_t>(first) + static_cast<std::uint64_t>(std::int64_t{step}));
  };
  for (size_t i = 0; i < n; ++i) static_cast<double*>(values)[i] = decimal(sum(steps[i]), places[i], origin);
  return true;
}

}  // namespace swath::pipeline
