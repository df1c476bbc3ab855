// SPDX-License-Identifier: GPL-3.0-or-later
// The files of a folder and what each of them is.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "core/config/value.h"

namespace swath::io {

/// One file of the folder: what describe_file says of it, or why it cannot.
struct FoundFile {
  std::filesystem::path name;  ///< relative to the folder
  core::Value facts{};         ///< null where it cannot be read
  std::string fault{};
};

/// Every file of the folder and the folders in it, by name; hidden ones, survey.toml, links to folders and the products of runs (folders
/// with a report.json) are passed over. What cannot be read, be it a folder, has its fault. `on_file`: called before each is read, with the
/// files read so far and their number. Throws core::Error: `folder` is not there or cannot be read.
std::vector<FoundFile> find_records(const std::filesystem::path& folder,
                                    const std::function<void(std::size_t, std::size_t, const std::filesystem::path&)>& on_file = {});

}  // namespace swath::io
