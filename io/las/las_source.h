// SPDX-License-Identifier: GPL-3.0-or-later
// Points of a cloud carried through a run whole: what a Block has no column for comes back when they are written.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/block.h"
#include "io/las/las_header.h"
#include "io/las/las_points.h"
#include "io/las/las_time.h"

namespace swath::io {

/// Keeps records (header.record_length bytes each) as rows of Block::source: {u32 number of the file from 1, record}, with zeros in place
/// of the coordinates, which are the block's.
void keep_source(std::span<const std::uint8_t> records, std::size_t record_length, std::uint32_t number, core::ByteRows& rows);

/// Columns that follow from the rows of Block::source, see LasSources::complete().
constexpr core::ColumnSet held_by_source{
    core::Column::intensity, core::Column::return_number, core::Column::return_count, core::Column::classification,
    core::Column::flags,     core::Column::scan_angle,    core::Column::range,        core::Column::incidence,
    core::Column::sigma_h,   core::Column::sigma_v,       core::Column::height,       core::Column::ground_probability,
    core::Column::red,       core::Column::green,         core::Column::blue,         core::Column::user_data};

/// A file that points of a run come from.
struct LasSource {
  std::filesystem::path file;
  LasHeader header;
  LasTime time;
  bool same_places = true;  ///< coordinates in units and CRS as they are in the file
};

/// The files of a run's points, in the order of their numbers.
class LasSources {
 public:
  /// `record_times`: times stay as recorded where all files have the same scale; otherwise adjusted standard GPS time is written.
  explicit LasSources(std::vector<LasSource> files, bool record_times = true);

  /// For files that hold points of all of them: version, point format, scale, extra fields, records and texts. With one file, or where
  /// they agree: offset, GUID, dates, system identifier and source id. Left out are records that describe a file's own bytes (COPC, spatial
  /// indices), those of the CRS unless `keep_crs`, and packets of waveforms larger than 64 MB.
  LasHeader header(bool keep_crs) const;
  /// What header() leaves out, in words.
  std::vector<std::string> left_out() const;
  /// Have all files the same GUID?
  bool same_project() const;

  /// Gives a block the columns of held_by_source that it lacks and one of the files has, as they were read.
  void complete(core::Block& block) const;

  /// Those of the columns that extra fields carry whose values are all as in the files, or that the block lacks.
  core::ColumnSet unchanged(const core::Block& block) const;

  /// Gives points made from the block what its columns do not hold: scanner channel, near infrared, waveform reference, extra fields, the
  /// recorded time; scan angle and class as recorded where the columns still say the same. `unchanged`: as above, of the whole file.
  /// Returns the number of points whose overlap flag the point format cannot hold.
  std::uint64_t restore(const core::Block& block, const LasHeader& out, core::ColumnSet unchanged, LasPoints& points) const;

 private:
  struct Part;
  template <class F>
  void each_part(const core::Block& block, F&& f) const;

  std::vector<LasSource> files_;
  std::vector<LasExtra> extras_;                 ///< of all files together
  std::vector<std::vector<std::size_t>> where_;  ///< place in extras_ of each file's extra fields
  core::ColumnSet held_;                         ///< columns that one of the files has
  bool keeps_times_ = true;
};

}  // namespace swath::io
