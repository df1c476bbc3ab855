// SPDX-License-Identifier: GPL-3.0-or-later
// Named lines or areas with numbers and texts, out as a layer of a GeoPackage.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace swath::io {

struct LineFeature {
  std::string name;
  std::vector<double> x, y;     ///< CRS units
  std::vector<double> numbers;  ///< in the order of the layer's fields
  std::vector<std::string> texts{};
};

struct LineLayer {
  std::string name, about;          ///< about: the layer's description
  std::vector<std::string> fields;  ///< of real numbers, beside `name`
  std::vector<LineFeature> lines;
  std::vector<std::string> text_fields{};  ///< behind `name`, before those of numbers
  bool are_areas = false;                  ///< closed lines around Polygons
};

/// GeoPackage 1.2, LineStrings or Polygons in the horizontal part of the CRS. Equal layers give equal bytes: the time stamp that the format
/// wants is a constant, 2000-01-01. Throws core::Error: unknown CRS, file not writable, disk full; nothing half-written stays.
void write_line_layer(const std::filesystem::path& file, const LineLayer& layer, const std::string& crs);

}  // namespace swath::io
