// SPDX-License-Identifier: GPL-3.0-or-later
// An even part of one or more clouds, as many points as a page can show.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/block.h"
#include "core/on_progress.h"
#include "io/las/las_reader.h"

namespace swath::tools {

struct CloudSample {
  core::Block points;                          ///< in Morton order; origin: a corner of the data, on the lattice of the first file
  Eigen::Vector3d scale{0.001, 0.001, 0.001};  ///< of the coordinates to be kept, units of the CRS
  std::uint64_t of = 0;                        ///< points that the files hold
};

/// Files of points by their headers.
struct CloudSources {
  struct Source {
    std::filesystem::path file;
    io::LasHeader header;
    io::LasPart part;
    std::uint64_t points = 0;  ///< of the part
  };
  std::vector<Source> files;
  std::uint64_t points = 0;
  std::string crs;  ///< definition, empty where the files state none
};

/// Reads the headers. Throws core::Error for files without a point, and where two files state different CRSs.
CloudSources open_clouds(const std::vector<std::filesystem::path>& files);

/// At most about `most` points of the files. Of COPC files only the levels are read that hold as many; of others every point, of which one
/// is kept or not by a number mixed of its place in the file: the choice is even, follows no scan line, and is always the same.
CloudSample sample_clouds(CloudSources sources, std::uint64_t most, const core::OnProgress& progress);

}  // namespace swath::tools
