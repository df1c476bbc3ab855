// SPDX-License-Identifier: GPL-3.0-or-later
// What a TOML or JSON file is, by its keys: a file given to the wrong command is named as what it is.
#pragma once

#include <filesystem>
#include <string_view>

#include "core/config/value.h"

namespace swath::io {

enum class TreeKind {
  other,
  pipeline,
  survey,
  hangar,
  tasks,
  report,
  calibration,
  flight_plan,
  block,
  block_theory,
  simulation,
  entwine,
  planned_flight,
};

TreeKind kind_of(const core::Value& tree);

/// "a pipeline", "a hangar survey" ...; empty for other.
std::string_view name_of(TreeKind kind);

/// The same without its article, as describe_file() states formats; "JSON or TOML" for other.
std::string_view format_of(TreeKind kind);

/// The kind whose format that is; other where none is.
TreeKind kind_of_format(std::string_view format);

/// The command or the key that takes such a file; empty for other.
std::string_view use_of(TreeKind kind);

/// Throws core::Error (usage) where the file is surely of another kind. What its keys leave open passes: its own reader judges them.
void require_kind(const core::Value& tree, TreeKind wanted, const std::filesystem::path& file);

}  // namespace swath::io
