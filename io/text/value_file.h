// SPDX-License-Identifier: GPL-3.0-or-later
// TOML and JSON files as core::Value trees with the place of every value, and back to JSON.
#pragma once

#include <filesystem>
#include <string>

#include "core/config/value.h"

namespace swath::io {

/// Reads .toml, or .json as the same tree. Throws Error with file:line:column.
core::Value read_value_file(const std::filesystem::path& file);

core::Value parse_toml(const std::string& text, const std::string& name);
core::Value parse_json(const std::string& text, const std::string& name);

/// JSON text, two blanks of indent; numbers shortest round-trip, NaN and infinities as null.
std::string to_json(const core::Value& v);

/// The whole text of a file; throws Error where it cannot be read.
std::string read_text_file(const std::filesystem::path& file);

}  // namespace swath::io
