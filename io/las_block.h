// SPDX-License-Identifier: GPL-3.0-or-later
// Points of LAS files to and from core::Block.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/block.h"
#include "core/time.h"
#include "io/las_header.h"
#include "io/las_points.h"

namespace swath::io {

/// How times of a file become GPS time.
struct LasTime {
  std::optional<int> week;            ///< GPS week of the first point, for files with seconds of week; roll-over is followed
  bool keep_seconds_of_week = false;  ///< without a week: seconds of week as they are, instead of an error
};

/// Names of the extra fields that carry columns of a Block.
namespace las_name {
constexpr const char *range = "range", *incidence = "incidence", *sigma_h = "sigma_h", *sigma_v = "sigma_v",
                     *height = "height_above_ground", *ground_probability = "ground_probability";
}

/// The extra fields written for those of the columns that need one: range (m, u32 * 0.001), incidence (deg, u16 * 0.002), sigma_h and
/// sigma_v (m, u32 * 0.0001), height_above_ground (m, i32 * 0.001), ground_probability (u16 * 0.0001); the extreme raw value is nodata (NaN
/// in the Block). LASzip keeps every byte in a layer of its own, so bytes that stay zero cost nothing.
std::vector<LasExtra> las_extras_of(core::ColumnSet columns);

/// Points to a Block with the block's origin kept; `first` is the file's row of the first point. Class 12 of formats 0 to 5 becomes the
/// overlap flag and class 1 (R15, table 9 note). Columns without a field stay empty; time is 0 in formats without it.
/// Throws core::Error where the times need a week and none is given.
void las_points_to_block(const LasPoints& points, const LasHeader& header, std::uint64_t first, const LasTime& time, double first_time,
                         const std::string& where, core::Block& block);

/// A Block to points of the header's format. Throws core::Error with the row where a coordinate does not fit scale and offset.
void block_to_las_points(const core::Block& block, const LasHeader& header, std::uint64_t first, const std::string& where,
                         LasPoints& points);

}  // namespace swath::io
