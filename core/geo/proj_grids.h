// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <vector>

#include "core/geo/crs.h"

namespace swath::core {

/// The files of datum shifts and geoids that PROJ has at hand for transformations between two CRSs, sorted: those of every operation that
/// it may choose. Empty where none takes any, or either CRS is empty.
std::vector<std::filesystem::path> grid_files_between(const Crs& from, const Crs& to);

}  // namespace swath::core
