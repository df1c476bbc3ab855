// SPDX-License-Identifier: GPL-3.0-or-later
// Which columns of a file of check points hold names and coordinates, for jobs on clouds.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace swath::pipeline {

/// Clouds with check points, as a command line names them.
struct CheckedClouds {
  std::vector<std::filesystem::path> files;
  std::string crs, check_crs;  ///< of --crs and --check-crs; empty: not given
};

/// Columns as [[control]] names them: by name, or by number from 1. All empty: those of the header are understood.
struct CheckColumns {
  std::string name, x, y, z;
  std::string note;  ///< how columns without names were judged, for the user; empty: they were not

  bool are_stated() const { return !x.empty(); }
};

/// `stated`: "name,x,y,z" or "x,y,z" as --check-columns has it; empty: by the header, and where the file has none, the three columns of
/// numbers, side by side and in either order of east and north, that put the points in the boxes of the clouds or within 1 km of them.
/// Throws core::Error (usage) with a hint at --check-columns where `stated` is no such list, where the header has no usual names, and where
/// none or several of these columns do.
CheckColumns check_columns(const std::filesystem::path& file, const std::string& stated, const CheckedClouds& clouds);

}  // namespace swath::pipeline
