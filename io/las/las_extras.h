// SPDX-License-Identifier: GPL-3.0-or-later
// Variable length records of LAS files, and the extra fields of points that one of them describes (ASPRS LAS 1.4 R15, 2.5 and 2.7.6).
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace swath::io {

/// A variable length record. `data` of waveform packets (LASF_Spec 65535) stay in the file: see `offset` and `size`.
struct LasVlr {
  std::string user_id;
  std::uint16_t record_id = 0;
  std::string description;
  std::vector<std::uint8_t> data;
  std::uint64_t offset = 0;  ///< byte of the data in the file that was read
  std::uint64_t size = 0;    ///< bytes of the data in the file that was read
};

constexpr std::size_t las_evlr_head = 60;  ///< bytes of an extended record before its data

/// One extra field of the records (R15, extra bytes VLR). A value is raw * scale + offset.
struct LasExtra {
  std::string name;         ///< up to 32 bytes
  std::string description;  ///< up to 32 bytes
  std::uint8_t type = 9;    ///< 0 raw bytes; 1 to 10: u8 i8 u16 i16 u32 i32 u64 i64 f32 f64; 11 to 30: two or three of them
  std::uint8_t bytes = 0;   ///< size of a field of type 0
  std::optional<std::array<std::uint64_t, 3>> nodata, min, max;  ///< bit patterns of u64, i64 or f64, as the type
  std::optional<std::array<double, 3>> scale, offset;
  std::vector<std::uint8_t> as_read;  ///< its 192 bytes in the file that was read, written again as they are; empty: made of the above

  int components() const { return type <= 10 ? 1 : type <= 20 ? 2 : 3; }
  /// Bytes in the record.
  int size() const;
};

/// The bit pattern that `nodata` of an integer field holds.
constexpr std::uint64_t las_integer_bits(std::int64_t v) { return static_cast<std::uint64_t>(v); }

/// The fields that the records describe, fitted to the `bytes` behind the standard fields; what is not described is raw bytes. Several
/// records are read one after the other, though the specification has one. What does not fit is added to `warnings`.
std::vector<LasExtra> extras_of(const std::vector<LasVlr>& vlrs, const std::vector<LasVlr>& evlrs, int bytes,
                                std::vector<std::string>& warnings);

/// The records with those of the extra fields: as they are where they still say the same, else one for all fields.
std::vector<LasVlr> with_extras(const std::vector<LasVlr>& vlrs, const std::vector<LasExtra>& extras);

}  // namespace swath::io
