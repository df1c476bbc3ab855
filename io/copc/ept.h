// SPDX-License-Identifier: GPL-3.0-or-later
// Clouds that are kept as many files: an EPT index, and a virtual point cloud.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <vector>

#include "io/survey/survey.h"

namespace swath::io {

/// What a file is of an EPT index.
struct EptNode {
  int level = 0;
  double spacing = 0.0;  ///< of the node's points, units of the file's CRS
  Eigen::Vector3d low{0, 0, 0}, high{0, 0, 0};
};

/// Of a file ept-data/KEY.laz beside an ept.json; nothing for others.
std::optional<EptNode> ept_node(const std::filesystem::path& file);

/// The files of an EPT index (Entwine Point Tile 1.0 and 1.1, encoding laszip): one per node with points, in the order of their keys.
/// `like`: what else the survey says of them; where it states no CRS they get that of the index. Throws core::Error, once and with the
/// file, for an index or hierarchy that is not whole, another encoding, and a node without its file.
std::vector<PointFile> ept_files(const std::filesystem::path& index, const PointFile& like);

/// The files that a virtual point cloud (.vpc: a STAC ItemCollection) lists. Throws core::Error for a file that is not there or not local.
std::vector<PointFile> vpc_files(const std::filesystem::path& list, const PointFile& like);

/// Puts in place of EPT indices and virtual point clouds the files that they list. Throws core::usage_error where a file is listed twice.
void expand_clouds(Survey& survey);

}  // namespace swath::io
