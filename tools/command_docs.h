// SPDX-License-Identifier: GPL-3.0-or-later
// The commands' own declarations as data, and what is generated from them: completion for shells, a manual page.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace swath::tools {

struct OptionText {
  std::vector<std::string> names;  ///< "-o", "--output"; a positional argument has its one name: "CONFIG"
  std::string help;
  bool positional = false, takes_value = false, is_required = false, is_repeated = false;
};

struct CommandText {
  std::string name, sentence;
  std::string examples;  ///< without their heading; may be empty
  std::vector<OptionText> options;
};

/// What the parser declares, in the order of the overview.
std::vector<CommandText> texts_of(const CLI::App& app);

/// Words that can follow: "dtm.cell=" of every option of every stage and of [run]; the stages; codes of warnings; configs by name.
struct Words {
  std::vector<std::string> sets, stages, warnings, configs;
};
Words known_words();

std::string bash_completion(const std::vector<CommandText>& commands, const Words& words);
std::string zsh_completion(const std::vector<CommandText>& commands, const Words& words);
std::string fish_completion(const std::vector<CommandText>& commands, const Words& words);

/// swath(1), in the man macros. `footer`: the last paragraph of the overview.
std::string manual_page(const std::vector<CommandText>& commands, const std::string& version, const std::string& footer);

}  // namespace swath::tools
