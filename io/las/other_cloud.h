// SPDX-License-Identifier: GPL-3.0-or-later
// Point clouds of formats that are not read here: what they are, and how they become LAZ.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace swath::io {

enum class OtherCloud { none, ply, e57, pcd, text };

/// What a file is by its first bytes, some hundreds where it has them; `none`: nothing that is known.
OtherCloud other_cloud(std::string_view start);

/// "a PLY file"; `kind` is not none.
std::string name_of(OtherCloud kind);

/// How such a file becomes one that is read here.
std::string conversion_of(OtherCloud kind, const std::filesystem::path& file);

}  // namespace swath::io
