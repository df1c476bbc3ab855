// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "core/printable.h"

namespace swath::io {

/// Whether the file's name ends in .las or .laz, in capitals or not.
inline bool has_las_ending(const std::filesystem::path& file) {
  const std::string ending = core::lower_case(file.extension().string());
  return ending == ".las" || ending == ".laz";
}

}  // namespace swath::io
