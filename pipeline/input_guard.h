// SPDX-License-Identifier: GPL-3.0-or-later
// No product takes the place of a file that the run reads, whatever names, links and folders lead to it.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <utility>
#include <vector>

#include "pipeline/plan.h"

namespace swath::pipeline {

/// The files of a plan: config, survey.toml, whatever the survey names, what its stages read and what lies beside these. Those that are
/// there.
std::vector<std::filesystem::path> files_of(const Plan& plan);

class InputGuard {
 public:
  explicit InputGuard(const std::vector<std::filesystem::path>& files);

  /// Throws core::Error (usage) where `product`, a file or a folder, is one of the files or holds one, also through links.
  void expect_apart(const std::filesystem::path& product) const;

 private:
  void expect_other(const std::filesystem::path& there, const std::filesystem::path& product) const;
  std::map<std::filesystem::path, std::filesystem::path> files_;  ///< canonical, as named; what a folder holds follows its name
  std::map<std::pair<std::uint64_t, std::uint64_t>, std::filesystem::path> ids_;
};

/// For a delivery: throws core::SystemError (the work stays) for a file of the plan, whatever name a stage gave its product.
std::function<void(const std::filesystem::path&)> outside_inputs(const Plan& plan);

/// The files that the plan's stages read.
std::vector<std::filesystem::path> input_files(const Plan& plan);

/// Whether the products of the plan can get their names in its output folder: core::Error (usage) where one would take the place of a file
/// of the plan, a folder has the name of a file or the other way around, or a path is longer than the system takes.
void check_output(const Plan& plan);

}  // namespace swath::pipeline
