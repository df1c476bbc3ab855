// SPDX-License-Identifier: GPL-3.0-or-later
// A coordinate of a file is a whole number of its steps, rounded to the places of a double twice: as the file's own number, and where the
// file's offset was taken from it. The second leaves multiples of one power of two: the number of steps, rounded to that, is the
// coordinate or lies a place beside it.
#include "io/text/packed_column.h"

#include <zstd.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <memory>
#include <numeric>
#include <span>
#include <vector>

#include "core/wide.h"
#include "io/text/byte_planes.h"

namespace swath::io {
namespace {

constexpr int level = 1;
constexpr size_t sampled = 4096;                               // values, for the choice of the way
constexpr size_t sampled_rows = 2048, widest_of_fields = 512;  // bytes; rows that are wider are packed as they are

enum Way : std::uint32_t { plain, differences, decimals, rows };

/// Room for some values that are there no longer than the next call, of whatever bytes there were before.
class Room {
 public:
  template <class T>
  T* of(size_t n) {
    const size_t words = (n * sizeof(T) + 7) / 8;
    if (words_.size() < words) words_.resize(words);
    return reinterpret_cast<T*>(words_.data());
  }

 private:
  std::vector<std::uint64_t> words_;
};

struct Codec {
  std::unique_ptr<ZSTD_CCtx, decltype(&ZSTD_freeCCtx)> pack{ZSTD_createCCtx(), &ZSTD_freeCCtx};
  std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> unpack{ZSTD_createDCtx(), &ZSTD_freeDCtx};
  Room planes, packed;
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

/// Small ones of both signs have only low bits.
template <class T>
void difference(T* v, size_t n) {
  for (size_t i = n; i-- > 1;) {
    const auto d = static_cast<T>(v[i] - v[i - 1]);
    v[i] = static_cast<T>(static_cast<T>(d << 1) ^ static_cast<T>(0 - (d >> (8 * sizeof(T) - 1))));
  }
}

template <class T>
void add_up(T* v, size_t n) {
  for (size_t i = 1; i < n; ++i) v[i] = static_cast<T>(v[i - 1] + static_cast<T>((v[i] >> 1) ^ static_cast<T>(0 - (v[i] & 1))));
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

/// Compressed into codec().packed; where, and how many bytes.
std::span<const char> compress(const void* values, size_t n, size_t width, Way way) {
  Codec& c = codec();
  const auto own = std::make_unique_for_overwrite<std::uint8_t[]>(n * width);
  if (n > 0) std::memcpy(own.get(), values, n * width);
  if (way == differences) as_numbers(own.get(), width, [n](auto* v) { difference(v, n); });
  auto* planes = c.planes.of<std::uint8_t>(n * width);
  to_planes(own.get(), n, width, planes);
  const size_t bound = ZSTD_compressBound(n * width);
  char* packed = c.packed.of<char>(bound);
  const size_t size = ZSTD_compressCCtx(c.pack.get(), packed, bound, planes, n * width, level);
  if (ZSTD_isError(size)) throw std::bad_alloc();  // with room enough nothing else fails
  return {packed, size};
}

void put_head(Way way, size_t bytes, std::string& out) {
  const PackedHead head{way, static_cast<std::uint32_t>(bytes)};
  out.append(reinterpret_cast<const char*>(&head), sizeof head);
}

void put(const void* values, size_t n, size_t width, Way way, std::string& out) {
  const std::span<const char> packed = compress(values, n, width, way);
  put_head(way, packed.size(), out);
  out.append(packed.data(), packed.size());
}

Way smaller_way(const void* values, size_t n, size_t width) {
  if (!has_numbers(width) || n < 2) return plain;
  n = std::min(n, sampled);
  return compress(values, n, width, differences).size() < compress(values, n, width, plain).size() ? differences : plain;
}

/// The unit of the last place of a number.
double last_place(double v) {
  const std::uint64_t exponent = (std::bit_cast<std::uint64_t>(v) >> 52) & 0x7ff;
  return exponent > 52 ? std::bit_cast<double>((exponent - 52) << 52) : 0.0;
}

/// The largest power of two that all values are multiples of; 0: there is none.
double common_place(const double* values, size_t n) {
  double out = std::numeric_limits<double>::infinity();
  for (size_t i = 0; i < n; ++i) {
    if (values[i] == 0.0) continue;
    const std::uint64_t fraction = std::bit_cast<std::uint64_t>(values[i]) | (std::uint64_t{1} << 52);
    out = std::min(out, last_place(values[i]) * static_cast<double>(fraction & (~fraction + 1)));
  }
  return std::isfinite(out) && out > 1e-100 ? out : 0.0;
}

/// Coordinates as numbers of steps.
struct Steps {
  std::int64_t first = 0;
  double per_metre = 0.0;
  double scale = 0.0;  ///< m, that numbers of steps were multiplied by; 0: they were divided by per_metre
  double place = 1.0;  ///< a power of two that all are multiples of

  double rounded(std::int64_t steps) const {
    const double v = scale > 0.0 ? static_cast<double>(steps) * scale : static_cast<double>(steps) / per_metre, whole = v / place;
    if (!(std::abs(whole) < 0x1p52)) return v;
    const double shift = std::copysign(0x1p52, whole);  // what is added to it keeps no places behind the point
    return ((whole + shift) - shift) * place;
  }
  double unit(double v) const { return std::max(place, last_place(v)); }
};

bool to_steps(const double* values, size_t n, Steps& s, std::int32_t* steps, std::int8_t* rests) {
  constexpr double most = 2e9;  // fit into 32 bits as differences from the first
  for (size_t i = 0; i < n; ++i) {
    const double v = values[i], scaled = v * s.per_metre;
    if (!(std::abs(scaled) < 1e15)) return false;
    const auto number = static_cast<std::int64_t>(scaled + std::copysign(0.5, scaled));
    if (i == 0) s.first = number;
    const double rounded = s.rounded(number), unit = s.unit(rounded), rest = (v - rounded) / unit;
    if (!(std::abs(rest) <= 127.0) || std::abs(static_cast<double>(number - s.first)) > most) return false;
    steps[i] = static_cast<std::int32_t>(number - s.first);
    rests[i] = static_cast<std::int8_t>(rest);
    if (std::bit_cast<std::int64_t>(rounded + rests[i] * unit) != std::bit_cast<std::int64_t>(v)) return false;
  }
  return true;
}

/// What to_steps() has taken apart, by the same roundings.
template <bool is_multiplied>
inline void to_values(const Steps& s, const std::int32_t* __restrict steps, const std::int8_t* __restrict rests, size_t n,
                      double* __restrict values) {
  const double first = static_cast<double>(s.first), scale = s.scale, per_metre = s.per_metre, place = s.place, per_place = 1.0 / place;
  for (size_t i = 0; i < n; ++i) {
    const double number = first + steps[i];
    const double v = is_multiplied ? number * scale : number / per_metre, whole = v * per_place;
    const double shift = std::copysign(0x1p52, whole), rounded = std::abs(whole) < 0x1p52 ? ((whole + shift) - shift) * place : v;
    const std::uint64_t exponent = (std::bit_cast<std::uint64_t>(rounded) >> 52) & 0x7ff;
    const double last = std::bit_cast<double>(exponent > 52 ? (exponent - 52) << 52 : std::uint64_t{0});
    values[i] = rounded + rests[i] * (place < last ? last : place);
  }
}
SWATH_WIDE void multiplied(const Steps& s, const std::int32_t* steps, const std::int8_t* rests, size_t n, double* values) {
  to_values<true>(s, steps, rests, n, values);
}
SWATH_WIDE void divided(const Steps& s, const std::int32_t* steps, const std::int8_t* rests, size_t n, double* values) {
  to_values<false>(s, steps, rests, n, values);
}

bool inflate(const char* bytes, size_t size, void* values, size_t n, size_t width, bool summed) {
  if (ZSTD_getFrameContentSize(bytes, size) != n * width) return false;  // nor where the frame does not say
  Codec& c = codec();
  auto* planes = c.planes.of<std::uint8_t>(n * width);
  const size_t got = ZSTD_decompressDCtx(c.unpack.get(), planes, n * width, bytes, size);
  if (ZSTD_isError(got) || got != n * width) return false;
  from_planes(planes, n, width, static_cast<std::uint8_t*>(values));
  if (summed) as_numbers(values, width, [n](auto* v) { add_up(v, n); });
  return true;
}

/// The bytes `first` to `first + width` of each row.
std::vector<std::uint8_t> field_of(const std::uint8_t* from, size_t n, size_t row, size_t first, size_t width) {
  std::vector<std::uint8_t> out(n * width);
  with_width(width, [&](auto constant) {
    for (size_t i = 0; i < n; ++i) std::memcpy(out.data() + i * constant, from + i * row + first, constant);
  });
  return out;
}

/// Takes {head, packed values} off the front of `bytes`; false where they are not of `n` values of `width` bytes.
bool take_inflated(const char*& bytes, size_t& size, void* values, size_t n, size_t width) {
  PackedHead head;
  if (size < sizeof head) return false;
  std::memcpy(&head, bytes, sizeof head);
  bytes += sizeof head, size -= sizeof head;
  if (head.way > differences || head.bytes > size || (head.way == differences && !has_numbers(width))) return false;
  if (!inflate(bytes, head.bytes, values, n, width, head.way == differences)) return false;
  bytes += head.bytes, size -= head.bytes;
  return true;
}

bool unpack_coordinates(const char* bytes, size_t size, double* values, size_t n) {
  Steps s;
  if (size < sizeof s) return false;
  std::memcpy(&s, bytes, sizeof s);
  bytes += sizeof s, size -= sizeof s;
  const auto steps = std::make_unique_for_overwrite<std::int32_t[]>(n);
  const auto rests = std::make_unique_for_overwrite<std::int8_t[]>(n);
  if (!take_inflated(bytes, size, steps.get(), n, 4) || !take_inflated(bytes, size, rests.get(), n, 1) || size > 0) return false;
  s.scale > 0.0 ? multiplied(s, steps.get(), rests.get(), n, values) : divided(s, steps.get(), rests.get(), n, values);
  return true;
}

bool unpack_rows(const char* bytes, size_t size, std::uint8_t* values, size_t n, size_t width) {
  std::uint32_t count = 0;
  if (size < sizeof count) return false;
  std::memcpy(&count, bytes, sizeof count);
  bytes += sizeof count, size -= sizeof count;
  if (count > size) return false;
  const char* widths = bytes;
  bytes += count, size -= count;
  std::vector<std::uint8_t> field;
  size_t first = 0;
  for (std::uint32_t k = 0; k < count; ++k) {
    const auto wide = static_cast<std::uint8_t>(widths[k]);
    if (!has_numbers(wide) || wide > width - first) return false;
    field.resize(n * wide);
    if (!take_inflated(bytes, size, field.data(), n, wide)) return false;
    with_width(wide, [&](auto constant) {
      for (size_t i = 0; i < n; ++i) std::memcpy(values + i * width + first, field.data() + i * constant, constant);
    });
    first += wide;
  }
  return first == width && size == 0;
}

}  // namespace

void pack(const void* values, size_t n, size_t width, std::string& out) { put(values, n, width, smaller_way(values, n, width), out); }

void pack_coordinates(const double* values, size_t n, std::string& out) {
  constexpr double foot = 0.3048, survey_foot = 1200.0 / 3937.0;
  const auto own_steps = std::make_unique_for_overwrite<std::int32_t[]>(n);
  const auto own_rests = std::make_unique_for_overwrite<std::int8_t[]>(n);
  std::int32_t* const steps = own_steps.get();
  std::int8_t* const rests = own_rests.get();
  Steps s;
  s.place = common_place(values, n);
  bool found = false;
  if (s.place > 0.0)
    for (const double per_metre : {1e2, 1e3, 1e4, 1e5, 1e2 / foot, 1e3 / foot, 1e2 / survey_foot, 1e3 / survey_foot}) {
      s.per_metre = per_metre;
      const size_t some = std::min(n, sampled);
      const auto inexact = [&](double scale) {
        s.scale = scale;
        return to_steps(values, some, s, steps, rests)
                   ? static_cast<size_t>(std::count_if(rests, rests + some, [](auto r) { return r != 0; }))
                   : some + 1;
      };
      const size_t divided = inexact(0.0), multiplied = inexact(1.0 / per_metre);
      if (divided > some && multiplied > some) continue;
      s.scale = multiplied < divided ? 1.0 / per_metre : 0.0;
      if ((found = to_steps(values, n, s, steps, rests))) break;
    }
  if (!found) return pack(values, n, 8, out);
  std::string parts(reinterpret_cast<const char*>(&s), sizeof s);
  pack(steps, n, 4, parts);
  pack(rests, n, 1, parts);
  put_head(decimals, parts.size(), out);
  out += parts;
}

std::vector<std::uint8_t> fields_of_rows(const std::uint8_t* rows, size_t n, size_t width) {
  if (width > widest_of_fields || n < 2) return {};
  n = std::min(n, sampled_rows);
  struct Best {
    size_t bytes = std::numeric_limits<size_t>::max();
    std::uint8_t last = 0;  // width of the last field
  };
  std::vector<Best> to(width + 1);  // of the first bytes of a row
  to[0].bytes = 0;
  for (size_t first = 0; first < width; ++first)
    for (const size_t wide : {1u, 2u, 4u, 8u}) {
      if (first + wide > width) break;
      const std::vector<std::uint8_t> field = field_of(rows, n, width, first, wide);
      const size_t packed = std::min(compress(field.data(), n, wide, plain).size(), compress(field.data(), n, wide, differences).size());
      const size_t bytes = to[first].bytes + packed + sizeof(PackedHead);
      if (bytes < to[first + wide].bytes) to[first + wide] = {bytes, static_cast<std::uint8_t>(wide)};
    }
  std::vector<std::uint8_t> out;
  for (size_t at = width; at > 0; at -= to[at].last) out.push_back(to[at].last);
  std::reverse(out.begin(), out.end());
  return out;
}

void pack_rows(const std::uint8_t* values, size_t n, size_t width, const std::vector<std::uint8_t>& fields, std::string& out) {
  if (std::accumulate(fields.begin(), fields.end(), size_t{0}) != width || width == 0) return pack(values, n, width, out);
  const auto count = static_cast<std::uint32_t>(fields.size());
  std::string parts(reinterpret_cast<const char*>(&count), sizeof count);
  parts.append(reinterpret_cast<const char*>(fields.data()), count);
  size_t first = 0;
  for (const std::uint8_t wide : fields) {
    pack(field_of(values, n, width, first, wide).data(), n, wide, parts);
    first += wide;
  }
  put_head(rows, parts.size(), out);
  out += parts;
}

bool unpack(const PackedHead& head, const char* bytes, void* values, size_t n, size_t width) {
  switch (head.way) {
    case plain:
      return inflate(bytes, head.bytes, values, n, width, false);
    case differences:
      return has_numbers(width) && inflate(bytes, head.bytes, values, n, width, true);
    case decimals:
      return width == 8 && unpack_coordinates(bytes, head.bytes, static_cast<double*>(values), n);
    case rows:
      return unpack_rows(bytes, head.bytes, static_cast<std::uint8_t*>(values), n, width);
    default:
      return false;
  }
}

}  // namespace swath::io
