// SPDX-License-Identifier: GPL-3.0-or-later
// A survey.toml proposed from the files of a folder.
#pragma once

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

struct Proposal {
  std::string toml;               ///< what is known as keys; what is not as comments that begin with "# ?" and say why
  std::size_t files = 0;          ///< that have a place in it
  std::vector<std::string> open;  ///< what remains to be stated, "gnss[1] time.week: ..."
  std::string config = "survey";  ///< that comes with the program and fits the files
};

/// The survey that the files make, named `name`. `swath check` passes once what is open is filled in.
Proposal propose_survey(const std::vector<FoundFile>& files, const std::string& name);

}  // namespace swath::io
