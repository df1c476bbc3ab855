// SPDX-License-Identifier: GPL-3.0-or-later
// Products of a block: orientations, cameras and points as files.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "calib/block/block_adjust.h"
#include "calib/block/block_findings.h"
#include "calib/block/block_reading.h"

namespace swath::calib {

/// orientation.csv: a header with the conventions, then a line per image.
std::string orientation_csv(const ReadBlock& read, const BlockConfig& config, const BlockSolution& solution);
/// camera.toml: what [[camera]] takes, with the sigmas found.
std::string camera_toml(const ReadBlock& read, const BlockConfig& config, const BlockFound& found);

/// Names of what write_block() may write into its folder.
std::vector<std::string> block_products();

/// Writes all products into a folder; returns their names. COLMAP needs cameras with pixels and is left out without them.
std::vector<std::string> write_block(const std::filesystem::path& folder, const ReadBlock& read, const BlockConfig& config,
                                     const BlockSolution& solution, const BlockFound& found);

}  // namespace swath::calib
