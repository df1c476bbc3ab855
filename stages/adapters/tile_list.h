// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace swath::stages {

/// Keeps `folder`/tiles.json, the list of the tiles that make the product, and removes tiles of an earlier run that are no longer in it.
void keep_list(const std::filesystem::path& folder, const std::vector<std::string>& files);

}  // namespace swath::stages
