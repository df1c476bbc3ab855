// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/records/gnss_data.h"

namespace swath::io {

/// Writes fixes as a solution file of RTKLIB's form: GPS week and seconds, ECEF to 0.1 mm, quality, satellites, standard deviations and
/// signed square roots of covariances to 0.1 mm. `remarks` go into its head. Throws Error where the file cannot be written.
void write_pos(const std::filesystem::path& file, const core::GnssData& fixes, const std::vector<std::string>& remarks);

}  // namespace swath::io
