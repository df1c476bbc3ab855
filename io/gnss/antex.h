// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace swath::io {

/// Types of the receiver antennas that an ANTEX file describes, as written there ("TRM41249.00     NONE"); satellites are left out.
/// Throws Error where the file is no ANTEX or has no antenna.
std::vector<std::string> antex_types(const std::filesystem::path& file);

/// The type of the file that is meant by `type`: the same antenna and radome (blanks do not count); or, where the file has none with that
/// radome, the antenna without one. Throws Error naming the nearest type.
std::string find_antenna(const std::vector<std::string>& types, const std::string& type, const std::filesystem::path& file);

}  // namespace swath::io
