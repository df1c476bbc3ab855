// SPDX-License-Identifier: GPL-3.0-or-later
// Values as TOML text; value_file.h reads them back.
#pragma once

#include <string>

#include "core/config/value.h"

namespace swath::io {

/// A tree as TOML: scalars first, then tables and lists of tables. Throws Error for lists of mixed kinds.
std::string to_toml(const core::Value& tree);

/// One value that is no table, as the right side of a line. Throws Error for a table.
std::string toml_scalar(const core::Value& value);

/// A list whose items are tables, [[name]] in TOML.
bool is_table_list(const core::Value& value);

}  // namespace swath::io
