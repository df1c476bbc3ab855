// SPDX-License-Identifier: GPL-3.0-or-later
// Points of LAS files to and from core::Block.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/block.h"
#include "io/las/las_header.h"
#include "io/las/las_points.h"
#include "io/las/las_time.h"

namespace swath::io {

/// Names of the extra fields that carry columns of a Block.
namespace las_name {
constexpr const char *range = "range", *incidence = "incidence", *sigma_h = "sigma_h", *sigma_v = "sigma_v",
                     *height = "height_above_ground", *ground_probability = "ground_probability";
}

/// The columns of a Block that LAS files carry as extra fields: calls f(Column, name, pointer to member) for each.
template <class F>
void for_each_extra_column(F&& f) {
  f(core::Column::range, las_name::range, &core::Block::range);
  f(core::Column::incidence, las_name::incidence, &core::Block::incidence);
  f(core::Column::sigma_h, las_name::sigma_h, &core::Block::sigma_h);
  f(core::Column::sigma_v, las_name::sigma_v, &core::Block::sigma_v);
  f(core::Column::height, las_name::height, &core::Block::height);
  f(core::Column::ground_probability, las_name::ground_probability, &core::Block::ground_probability);
}

/// Class of formats 0 to 5 that the overlap flag stands for in formats 6 to 10.
constexpr std::uint8_t legacy_overlap_class = 12;

/// The extra fields written for those of the columns that need one: range (m, u32 * 0.001), incidence (deg, u16 * 0.002), sigma_h and
/// sigma_v (m, u32 * 0.0001), whose extreme raw value is nodata (NaN in the Block); height_above_ground (m) and ground_probability as
/// floats with NaN where unknown, rounded to 1/1024 m and 1/16384. LASzip keeps every byte in a layer of its own, so bytes that stay zero
/// cost nothing.
std::vector<LasExtra> las_extras_of(core::ColumnSet columns);

/// Points to a Block with the block's origin kept; `first` is the file's row of the first point, `read` what las_gps_times() carries. Class
/// 12 of formats 0 to 5 becomes the overlap flag and class 1 (R15, table 9 note). Columns without a field stay empty; time is 0 in formats
/// without it. Throws core::Error where the times need a week and none is given, see las_gps_times().
void las_points_to_block(const LasPoints& points, const LasHeader& header, std::uint64_t first, const LasTime& time, LasTimesRead& read,
                         const std::string& where, core::Block& block);

/// A Block to points of the header's format. Times are written as adjusted standard GPS time where the header's bit says so, else as they
/// are. `carried`: columns whose extra fields are left as they are. Throws core::Error with the row where a coordinate does not fit scale
/// and offset.
void block_to_las_points(const core::Block& block, const LasHeader& header, std::uint64_t first, const std::string& where,
                         LasPoints& points, core::ColumnSet carried = {});

}  // namespace swath::io
