// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace swath::stages {

/// Writes `folder`/tiles.json, the list of the tiles that make the product; delivery removes tiles of an earlier run by it.
void write_list(const std::filesystem::path& folder, const std::vector<std::string>& files);

}  // namespace swath::stages
