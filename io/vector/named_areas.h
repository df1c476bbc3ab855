// SPDX-License-Identifier: GPL-3.0-or-later
// Areas with names: the sheets of a map, a client's tiles.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace swath::io {

/// Polygons of a vector file, each with the text of one field.
class NamedAreas {
 public:
  /// `crs`: that of the places asked for, as text that PROJ knows. Throws core::Error where the file has no polygon, no such field,
  /// another horizontal CRS, or a name that cannot be that of a file.
  NamedAreas(const std::filesystem::path& file, const std::string& field, const std::string& crs);
  /// The name of the area that holds the place (CRS units). Throws core::Error where none or several do.
  const std::string& at(double x, double y) const;

 private:
  struct Area {
    std::string name;
    std::vector<std::vector<double>> x, y;  ///< of its rings
    bool holds(double px, double py) const;
  };
  std::filesystem::path file_;
  std::vector<Area> areas_;
};

}  // namespace swath::io
