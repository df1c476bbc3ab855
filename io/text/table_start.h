// SPDX-License-Identifier: GPL-3.0-or-later
// Programs that process flights describe them above the table that they export: project, datum, units of the columns.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace swath::io {

/// Numbers of lines, from 1; 0: none.
struct TableStart {
  std::uint64_t names = 0;  ///< the line of the columns' names
  std::uint64_t data = 0;   ///< the first line of numbers
};

/// Where the table begins in a text with other lines before it, or with a line of units below its names. Nothing (both 0) where the file
/// begins with its records, with one line of names, or with a line of names and one that looks like a record, even a damaged one: what is
/// wrong there is for the reader to say. The table is the first two lines of numbers of one length; the names are the nearest line
/// above it that has a word for each column, or the line above that where the nearest holds the columns' units. `delimiter`: as stated, or
/// "".
TableStart table_start(const std::filesystem::path& file, const std::string& delimiter = {});

}  // namespace swath::io
