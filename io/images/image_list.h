// SPDX-License-Identifier: GPL-3.0-or-later
// Lists of images: which event each of them is.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "io/survey/camera_file.h"

namespace swath::io {

struct ListedImage {
  std::string name, event;
  std::optional<std::string> camera{};  ///< none: there is no such column, or nothing in it
  std::optional<int> strip{};           ///< the same
  std::string place;                    ///< "file:line"
};

/// The rows of a table, which is at `path`. Throws core::Error with file and line: a column missing, a name or an event left empty, a strip
/// that is not a whole number.
std::vector<ListedImage> read_listed_images(const std::filesystem::path& path, const ImageListFile& file);

}  // namespace swath::io
