// SPDX-License-Identifier: GPL-3.0-or-later
// The public header block of LAS 1.0 to 1.4 with its variable length records (ASPRS LAS 1.4 R15, sections 2.4 to 2.7).
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "io/las/las_extras.h"

namespace swath::io {

/// What the records of one point format hold besides the fields that all formats have (R15, tables 7 to 16).
struct LasLayout {
  int format = 6;
  bool extended = true;  ///< formats 6 to 10: 15 returns, 8-bit class, scanner channel, 16-bit scan angle
  bool gps = true, rgb = false, nir = false, wave = false;
  int size = 30;  ///< bytes without extra bytes
};

/// The layout of point format 0 to 10; nothing for others.
std::optional<LasLayout> las_layout(int format);

/// Bits of LasHeader::global_encoding.
namespace las_encoding {
constexpr std::uint16_t adjusted_gps_time = 1u << 0, waveform_internal = 1u << 1, waveform_external = 1u << 2, synthetic_returns = 1u << 3,
                        wkt = 1u << 4;
}

struct LasHeader {
  int version_major = 1, version_minor = 4;
  std::uint16_t file_source_id = 0;
  std::uint16_t global_encoding = 0;
  std::array<std::uint8_t, 16> guid{};
  std::string system_identifier, generating_software;
  std::uint16_t creation_day = 0, creation_year = 0;  ///< day of year from 1; 0 0 = not stated
  std::uint32_t offset_to_points = 0;
  int point_format = 6;
  bool compressed = false;
  std::uint16_t record_length = 30;
  std::uint64_t point_count = 0;              ///< the 64-bit count, or the legacy one before LAS 1.4
  std::uint32_t legacy_point_count = 0;       ///< 0 in formats 6 to 10
  std::array<std::uint64_t, 15> by_return{};  ///< points by return number, from 1
  std::array<std::uint32_t, 5> legacy_by_return{};
  Eigen::Vector3d scale{0.001, 0.001, 0.001}, offset{0, 0, 0};
  Eigen::Vector3d min{0, 0, 0}, max{0, 0, 0};  ///< as stated, CRS units
  std::uint64_t waveform_start = 0;
  std::vector<LasVlr> vlrs, evlrs;   ///< without the laszip VLR and, when read, with the extra bytes VLR
  std::vector<LasExtra> extras;      ///< fields behind the standard ones, in order; bytes that no VLR describes are one of type 0
  std::vector<std::uint8_t> laszip;  ///< record data of the laszip VLR

  bool gps_time_is_adjusted() const { return global_encoding & las_encoding::adjusted_gps_time; }
  int extra_bytes() const;
  /// Place of an extra field within the extra bytes; nothing where no field has the name.
  std::optional<int> extra_offset(const std::string& name) const;
};

/// Reads and checks header, VLRs and EVLRs. Throws core::Error naming file and byte: wrong magic, unknown version or format, record
/// length below the format's, scale or offset not finite or zero, counts that contradict each other or the file's size, VLRs that
/// leave their place. What is odd and harmless is added to `warnings`.
LasHeader read_las_header(const std::filesystem::path& file, std::vector<std::string>& warnings);

/// Header, VLRs (extra bytes VLR made from `extras`, laszip VLR from `laszip`) up to the first point; sets `offset_to_points`.
/// Throws core::Error where the version cannot hold the format or the counts, or a VLR is too long.
std::vector<std::uint8_t> las_header_bytes(LasHeader& header, std::uint64_t evlr_start, const std::string& file);
/// All EVLRs of the header, one after the other.
std::vector<std::uint8_t> las_evlr_bytes(const LasHeader& header);

}  // namespace swath::io
