// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <vector>

#include "core/geo/crs.h"

namespace swath::core {

/// The files of datum shifts and geoids that PROJ has at hand for transformations between two CRSs, sorted: those of every operation that
/// it may choose. Empty where none takes any, or either CRS is empty.
std::vector<std::filesystem::path> grid_files_between(const Crs& from, const Crs& to);

/// From now on PROJ finds its database and grids in these folders, the first that holds a file, in place of those that it was built for and
/// that the environment names; GDAL's PROJ, too. None: these again. Empty names are left out. To be called before other threads use PROJ.
void use_proj_folders(const std::vector<std::filesystem::path>& folders);

}  // namespace swath::core
