// SPDX-License-Identifier: GPL-3.0-or-later
// Point clouds named on the command line as a survey.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/config/value.h"

namespace swath::pipeline {

/// The files that names stand for, each once, in the order of the names: a file itself, a folder for its LAS and LAZ files, a pattern (*,
/// ?, [..]) for the files that match. Throws core::Error: no such file, nothing that matches, a folder that cannot be read.
std::vector<std::filesystem::path> cloud_files(const std::vector<std::string>& names);

/// Who names CRSs: hints say how.
enum class CrsNamed { on_command_line, in_pdal_pipeline };

/// A survey of these clouds with absolute names, as survey.toml would hold it. `crs`: of the products, and of clouds that state none;
/// empty: what the clouds state. Throws core::Error (usage) where they state none or different ones and `crs` is empty, or coordinates in
/// degrees.
core::Value cloud_survey(const std::vector<std::filesystem::path>& files, const std::string& crs, CrsNamed by = CrsNamed::on_command_line);

/// Why a cloud has no CRS of its own that can be used; empty where it has one. Of an index (EPT, virtual point cloud) that of its files.
/// Throws core::Error for a file that is not such a cloud.
std::string lack_of_crs(const std::filesystem::path& cloud);

/// The name of what is made of them: of the only file, or of the folder that all are in.
std::string cloud_name(const std::vector<std::filesystem::path>& files);

/// Where the products go when no folder is named: NAME_JOB in the working folder. Throws core::Error (usage) where that is there and holds
/// anything but an earlier run.
std::filesystem::path proposed_output(const std::vector<std::filesystem::path>& files, const std::string& job);

/// Does any LAS or LAZ file hold a point of the class? Reads until the first; true where a file is of another kind.
bool has_class(const std::vector<std::filesystem::path>& files, int point_class);

}  // namespace swath::pipeline
