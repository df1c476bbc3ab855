// SPDX-License-Identifier: GPL-3.0-or-later
// What a vector file holds of a map with heights, from one opening of the file.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "io/vector/spot_file.h"
#include "io/vector/vector.h"

namespace swath::io {

struct VectorMap {
  std::optional<double> height_unit;  ///< as height_unit_in()
  VectorLines lines;                  ///< as read_lines()
  SpotFile spots;                     ///< as spots_in()
};

/// All three of one file. Throws core::Error.
VectorMap read_map(const std::filesystem::path& file, const std::string& field = {});

}  // namespace swath::io
