// SPDX-License-Identifier: GPL-3.0-or-later
// What an earlier simulation left in a folder: records of other formats would lie beside the new ones and be taken for theirs.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace swath::simulate {

/// How survey.toml of a simulation begins.
inline constexpr const char* simulated_mark = "# Simulated survey";

class EarlierSurvey {
 public:
  /// Looks, before the new simulation, for files under the names that simulations write. Throws core::Error (usage) where they are not of a
  /// simulation, which has a folder truth/: records of a real survey would be overwritten.
  explicit EarlierSurvey(const std::filesystem::path& folder);
  /// Removes, after it, those that it has not written anew; their names in the folder, sorted. Other files stay, and
  /// `inputs` of the new one.
  std::vector<std::string> remove_stale(const std::vector<std::filesystem::path>& inputs = {}) const;

 private:
  std::filesystem::path folder_;
  std::map<std::string, std::filesystem::file_time_type> files_{};
};

}  // namespace swath::simulate
