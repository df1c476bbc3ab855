// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <vector>

#include "core/geo/crs.h"

namespace swath::core {

/// The files of datum shifts and geoids that PROJ has at hand for transformations between two CRSs, sorted: those of every operation that
/// it may choose. Empty where none takes any, or either CRS is empty.
std::vector<std::filesystem::path> grid_files_between(const Crs& from, const Crs& to);

/// From now on PROJ finds its database and grids in this folder, in place of the one that it was built for; GDAL's PROJ, too. Empty: that
/// one again. To be called before other threads use PROJ.
void use_proj_folder(const std::filesystem::path& folder);

}  // namespace swath::core
