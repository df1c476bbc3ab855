// SPDX-License-Identifier: GPL-3.0-or-later
// What of a cloud lies within the area of a run: the nodes of COPC files, files of EPT nodes, whole files.
#pragma once

#include <cstdint>
#include <optional>

#include "io/las/cloud_source.h"

namespace swath::io {

/// What is read of a file, and how many points the rest has.
struct CloudPart {
  std::optional<std::vector<LasChunk>> chunks{};  ///< as LasPart; unset: the whole file
  std::uint64_t points = 0, unread = 0;
};

/// The nodes whose cubes reach into the map's area, on the levels that are needed for points `resolution` metres apart. The hierarchy of a
/// COPC file is checked in any case. Throws core::Error where it is broken, and core::usage_error for a resolution where the file has no
/// levels.
CloudPart part_of_cloud(const Survey& survey, const PointFile& file, const CloudMap& map, std::optional<double> resolution);

}  // namespace swath::io
