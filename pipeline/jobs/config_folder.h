// SPDX-License-Identifier: GPL-3.0-or-later
// Configs that come with the program, found by their names.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace swath::pipeline {

/// The folder that the program's file is in; empty where the system does not say.
std::filesystem::path program_folder();

/// The folders of named configs, those that exist, in the order of the search: the environment's SWATH_CONFIGS; share/swath/configs beside
/// the program's own folder, where it is installed; configs/ of the sources, where it runs from build/NAME/tools.
std::vector<std::filesystem::path> config_folders();

/// Names of the configs that come with the program, sorted.
std::vector<std::string> config_names();

/// A config by its file or, where there is no such file, by the name of one that comes with the program: "survey". Throws core::Error
/// (usage) that names the nearest.
std::filesystem::path find_config(const std::filesystem::path& given);

}  // namespace swath::pipeline
