// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "core/block.h"
#include "io/las/las_block.h"
#include "io/las/las_crs.h"
#include "io/las/las_header.h"
#include "io/las/las_points.h"
#include "io/las/las_source.h"

namespace swath::io {

/// Writes raw fields as they are: any version and point format, LAZ where the name ends in .laz. The file appears whole at finish() or
/// not at all (io::OutputFile). Counts, bounds and legacy counts are made exact. The bytes depend on header and points alone, not on
/// batches or threads.
class LasRawWriter {
 public:
  /// `header`: version, format, scale, offset, encoding, extras, VLRs, EVLRs and texts are taken as they are; counts, bounds, lengths,
  /// `compressed` and `laszip` are made here. Throws core::Error where the version lacks the format.
  LasRawWriter(std::filesystem::path file, LasHeader header, unsigned threads = 0);
  ~LasRawWriter();
  LasRawWriter(LasRawWriter&&) noexcept;
  LasRawWriter& operator=(LasRawWriter&&) noexcept;

  /// As written so far: counts and bounds follow the points.
  const LasHeader& header() const;
  /// Appends points; columns that are empty count as zeros. Throws core::Error for a value that its field cannot hold.
  void write(const LasPoints& points);
  /// Completes the file and gives it its name.
  void finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// How Blocks are written. The creation date is 0 / 0 (not stated) unless given, so that equal input gives equal bytes on any day.
struct LasWriteOptions {
  std::optional<int> format;  ///< point format 0 to 10; unset: 7 where the first block has colours, else 6
  int version_minor = 4;
  Eigen::Vector3d scale{0.001, 0.001, 0.001};  ///< CRS units
  std::optional<Eigen::Vector3d> offset;       ///< unset: x and y of the first point to 100 000 units, z 0
  std::string crs_wkt;                         ///< WKT record; empty: none
  bool times_as_they_are = false;    ///< times of an unknown scale: written as they are (GPS time bit 0), not as adjusted standard GPS time
  bool extra_bytes = true;           ///< range, incidence, sigma_h, sigma_v, height_above_ground, ground_probability where a block has them
  std::uint16_t file_source_id = 0;  ///< flight line of a file of one line
  std::string system_identifier = "swath", generating_software = "swath";
  std::uint16_t creation_day = 0, creation_year = 0;  ///< day of year from 1
  std::array<std::uint8_t, 16> guid{};                ///< of the project
  unsigned threads = 0;                               ///< for LAZ: 1 the caller's, 0 one per processor
  /// For blocks with the column `source`: the files that their points came from, and the header to write in place of what is above
  /// (LasSources::header, with scale, offset and CRS as they are to be).
  std::shared_ptr<const LasSources> sources = {};
  LasHeader header = {};
};

/// Writes Blocks as LAS 1.4 (LAZ where the name ends in .laz): WKT, adjusted standard GPS time, scan angle in 0.006 deg units, point
/// source id = strip, LAS bits of the flags, extra bytes of las_extras_of() for the columns that the first block has.
/// Coordinates are rounded to the nearest multiple of the scale. Whole at finish() or not at all.
class LasWriter {
 public:
  LasWriter(std::filesystem::path file, LasWriteOptions options);
  ~LasWriter();
  LasWriter(LasWriter&&) noexcept;
  LasWriter& operator=(LasWriter&&) noexcept;

  /// A block that is to be written, before the first write(): fields of a file that is written in several blocks follow from all of them.
  void look_at(const core::Block& block);
  /// Throws core::Error with the point's number where a coordinate does not fit the 32 bits of scale and offset, a value does not fit
  /// its field, or the block lacks a column that the first one had (or has another extra one).
  void write(const core::Block& block);
  /// Completes the file; without any block it holds 0 points of format 6.
  void finish();
  /// Points written so far.
  std::uint64_t count() const;
  /// Of these, those with an overlap flag that the point format cannot hold.
  std::uint64_t overlap_lost() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace swath::io
