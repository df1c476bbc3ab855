// SPDX-License-Identifier: GPL-3.0-or-later
// Programs that process flights describe them above the table that they export: project, datum, units of the columns.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace swath::io {

/// Numbers of lines, from 1; 0: none.
struct TableStart {
  std::uint64_t names = 0;  ///< the line of the columns' names
  std::uint64_t data = 0;   ///< the first line of numbers
  std::uint64_t units = 0;  ///< the line of the columns' units
};

/// Where the table begins in a text with other lines before it, or with a line of units below its names. Nothing (both 0) where the file
/// begins with its records, with one line of names, or with a line of names and one that looks like a record, even a damaged one: what is
/// wrong there is for the reader to say. The table is the first two lines of numbers of one length; the names are the nearest line
/// above it that has a word for each column, or the line above that where the nearest holds the columns' units. `delimiter`: as stated, or
/// "".
TableStart table_start(const std::filesystem::path& file, const std::string& delimiter = {});

/// The names of a header over so many columns. A table below a description may have names between commas and numbers between blanks; where
/// blanks part both, names of several words ("ELLIPSOID HEIGHT") are parted by two blanks or more.
std::vector<std::string> header_names(const std::string& header, char delimiter, size_t columns, bool below_description);

/// The units of the columns by the row below their names, without brackets, lower case; "" for a column without one; empty where there is
/// no such row. Of fewer units than names each is that of the column that ends nearest to it.
std::vector<std::string> column_units(const std::filesystem::path& file, const std::string& delimiter = {});

}  // namespace swath::io
