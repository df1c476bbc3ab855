// SPDX-License-Identifier: GPL-3.0-or-later
// Points of LAS and LAZ files as columns by the names that LAS gives its fields.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/config/value.h"
#include "io/las/las_header.h"
#include "io/las/las_points.h"

namespace swath::python {

/// Calls f(name, pointer to member of io::LasPoints) for every field that is not an extra one.
template <class F>
void for_each_las_column(F&& f) {
  using P = io::LasPoints;
  f("x", &P::x), f("y", &P::y), f("z", &P::z), f("intensity", &P::intensity), f("return_number", &P::return_number);
  f("number_of_returns", &P::return_count), f("scan_direction_flag", &P::scan_direction), f("edge_of_flight_line", &P::edge_of_line);
  f("classification", &P::classification), f("flags", &P::flags), f("scanner_channel", &P::channel), f("scan_angle", &P::scan_angle);
  f("user_data", &P::user_data), f("point_source_id", &P::point_source_id), f("gps_time", &P::gps_time);
  f("red", &P::red), f("green", &P::green), f("blue", &P::blue), f("nir", &P::nir);
  f("wavepacket_index", &P::wave_descriptor), f("wavepacket_offset", &P::wave_offset), f("wavepacket_size", &P::wave_size);
  f("return_point_wave_location", &P::wave_location), f("x_t", &P::wave_dx), f("y_t", &P::wave_dy), f("z_t", &P::wave_dz);
}

/// An extra field: numbers where it has a scale or a value for "no data" (then NaN), otherwise the bytes as stored.
struct ExtraColumn {
  io::LasExtra field;
  std::vector<double> numbers;
  std::vector<std::uint8_t> bytes;
  bool has_numbers() const { return field.type >= 1 && field.type <= 10 && (field.scale || field.nodata); }
};

/// The points of all files, one file after the other.
struct LasCloud {
  io::LasHeader header;  ///< of the first file
  io::LasPoints points;  ///< without `extra` and the raw coordinates
  std::vector<ExtraColumn> extras;
  std::uint64_t size = 0;
  std::string crs;  ///< that the files state; empty: none
  std::vector<std::string> warnings;
};

/// Reads the files. `wanted`: these columns alone; nothing: all. A field that only some files have is 0 in the others. Throws core::Error
/// for a file that cannot be read, and for files that differ in CRS, time scale or the type of an extra field; pipeline::Interrupted on
/// `stop`.
LasCloud read_cloud(const std::vector<std::filesystem::path>& files, const std::optional<std::vector<std::string>>& wanted,
                    unsigned threads, const std::atomic<bool>& stop);

/// What Python keeps of a header, and the header again: {"scale", "offset", "point_format", "adjusted", "file_source_id", "extras"}.
core::Value value_of(const io::LasHeader& header);
io::LasHeader header_of(const core::Value& value, const std::string& crs);

}  // namespace swath::python
