// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "io/vector/vector.h"

namespace swath::io {

/// All lines into each of the files.
inline void write_contours(const std::vector<std::filesystem::path>& files, const std::vector<core::ContourLine>& lines,
                           const std::string& crs) {
  std::vector<ContourWriter> writers;
  for (const auto& file : files) writers.emplace_back(file, crs);
  for (const core::ContourLine& line : lines)
    for (ContourWriter& w : writers) w.add(line);
  for (ContourWriter& w : writers) w.close();
}

}  // namespace swath::io
