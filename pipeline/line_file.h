// SPDX-License-Identifier: GPL-3.0-or-later
// Lines and polygons of a vector file in the CRS of the data that they are laid over.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/geo/crs.h"
#include "io/vector/spot_file.h"
#include "io/vector/vector.h"

namespace swath::pipeline {

/// All lines of the file, x and y in the horizontal part of `crs`; z, where there is one, stays as the file has it. A file that states no
/// CRS (DXF), and any file where `crs` is empty, is taken as it is. Throws core::Error, naming both
/// CRSs where a place has no coordinates in the other.
/// `field`: the one with a line's height, where it has none of the usual names.
std::vector<io::VectorLine> read_lines_in(const std::filesystem::path& file, const core::Crs& crs, const std::string& field = {});
/// Brings what was read of `file` there. Throws as read_lines_in().
void move_into(const core::Crs& crs, const std::filesystem::path& file, io::VectorLines& read);
void move_into(const core::Crs& crs, const std::filesystem::path& file, io::SpotFile& read);

/// False for a place that is not finite or farther off than any map projection reaches.
bool is_on_a_map(double x, double y);

/// The polygons and closed lines among them, without the repeated vertex. `left_out`: vertices that are not finite, or farther off than any
/// map reaches. Throws core::Error where none is left.
std::vector<std::vector<Eigen::Vector2d>> read_rings_in(const std::filesystem::path& file, const core::Crs& crs, std::uint64_t& left_out);

}  // namespace swath::pipeline
