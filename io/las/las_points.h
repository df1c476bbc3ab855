// SPDX-License-Identifier: GPL-3.0-or-later
// Point records of LAS as columns: every field of point formats 0 to 10.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/block.h"
#include "io/las/las_header.h"

namespace swath::io {

/// Degrees per unit of the scan angle of formats 6 to 10 (R15 2.5.5).
constexpr double las_angle_step = 0.006;

/// Every field of n records. Fields that the point format lacks are empty.
struct LasPoints {
  std::vector<std::int32_t> raw_x, raw_y, raw_z;  ///< as stored
  std::vector<double> x, y, z;                    ///< raw * scale + offset, CRS units; made by decoding, not used by encoding
  std::vector<std::uint16_t> intensity;
  std::vector<std::uint8_t> return_number, return_count;
  std::vector<std::uint8_t> scan_direction, edge_of_line;  ///< 0 or 1
  std::vector<std::uint8_t> classification;                ///< class alone: 0 to 31 in formats 0 to 5, 0 to 255 in 6 to 10
  std::vector<std::uint8_t> flags;                         ///< core::flag synthetic, key_point, withheld, overlap
  std::vector<std::uint8_t> channel;                       ///< scanner channel 0 to 3 (formats 6 to 10)
  std::vector<std::int16_t> raw_scan_angle;                ///< degrees in formats 0 to 5, units of 0.006 degrees in 6 to 10
  std::vector<float> scan_angle;                           ///< degrees, positive to starboard; made by decoding, not used by encoding
  std::vector<std::uint8_t> user_data;
  std::vector<std::uint16_t> point_source_id;
  std::vector<double> gps_time;  ///< s, as stored: adjusted standard GPS time or seconds of week
  std::vector<std::uint16_t> red, green, blue, nir;
  std::vector<std::uint8_t> wave_descriptor;
  std::vector<std::uint64_t> wave_offset;
  std::vector<std::uint32_t> wave_size;
  std::vector<float> wave_location, wave_dx, wave_dy, wave_dz;
  std::vector<std::uint8_t> extra;  ///< LasHeader::extra_bytes() per point, as stored

  std::size_t size() const { return raw_x.size(); }
  bool operator==(const LasPoints&) const = default;
};

/// Gives every column that the header's format has n entries (new ones 0) and empties the others.
void resize(LasPoints& points, const LasHeader& header, std::size_t n);

/// Records (header.record_length bytes each) to columns; replaces what was in `points`.
void decode_las_points(std::span<const std::uint8_t> records, const LasHeader& header, LasPoints& points);

/// GPS time and point source id alone, of a format that has GPS time; replaces what was in the two columns.
void decode_las_lines(std::span<const std::uint8_t> records, const LasHeader& header, std::vector<double>& gps_time,
                      std::vector<double>& point_source_id);

/// Columns to records, rows begin to end; columns that are empty count as zeros. A value that its field cannot hold (return number 9 in
/// format 1) throws core::Error with `where` and the row.
void encode_las_points(const LasPoints& points, std::size_t begin, std::size_t end, const LasHeader& header,
                       std::span<std::uint8_t> records, const std::string& where);

/// One component of an extra field as numbers, raw * scale + offset; NaN where nodata. Empty where no field has the name.
std::vector<double> las_extra_values(const LasPoints& points, const LasHeader& header, const std::string& name, int component = 0);
/// Stores numbers as an extra field: nearest raw value; NaN becomes nodata. Throws core::Error (`where` and row) for a number that the
/// field cannot hold, or NaN where it has no nodata.
void set_las_extra_values(LasPoints& points, const LasHeader& header, const std::string& name, std::span<const double> values,
                          const std::string& where);

}  // namespace swath::io
