// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "core/config/value.h"

namespace swath::io {

/// What `describe_file` reports of tables of numbers: rows, columns with their smallest and largest value, `warnings`.
core::Value describe_csd(const std::filesystem::path& file);
core::Value describe_npy(const std::filesystem::path& file);
core::Value describe_text(const std::filesystem::path& file);

}  // namespace swath::io
