// SPDX-License-Identifier: GPL-3.0-or-later
// Mistakes of the command line, named so that the next one is right.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "core/error.h"

namespace swath::tools {

/// What to type in place of a word that is no command: the command that does it, `swath run` with the config of that name, or the nearest
/// name; empty: nothing is near.
std::string command_hint(const std::string& word, const std::vector<std::string>& commands, const std::vector<std::string>& configs);

/// A quantity whose unit was typed as a word of its own, "--cell 1 m": what to write. Empty where the words hold none, or a file has the
/// unit's name.
std::string split_quantity_hint(const std::vector<std::string>& words);

/// A fault that the parser found, in the form of every other error. `words`: the command line without the program.
core::Error usage_fault(const CLI::App& app, const CLI::ParseError& e, const std::vector<std::string>& words);

}  // namespace swath::tools
