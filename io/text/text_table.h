// SPDX-License-Identifier: GPL-3.0-or-later
// Short delimited tables whose fields are names as well as numbers (control, lists of observations).
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "io/text/delimited.h"

namespace swath::io {

/// Where the names of a table's columns are.
enum class Header {
  first_line,  ///< that is neither empty nor a comment (# or %)
  if_any,      ///< where inspect_delimited() finds them, or nowhere; a line with two numbers or more is a row
};

/// A whole table in memory.
class TextTable {
 public:
  /// `delimiter`: as inspect_delimited() takes it. Throws Error: file not readable, no row under the header, a row with more or fewer
  /// fields than the header, or the first row, has (with "file:line").
  explicit TextTable(const std::filesystem::path& file, const std::string& delimiter = {}, Header header = Header::first_line);

  /// The header's names; empty where there is none, and columns are named by their numbers from 1.
  const std::vector<std::string>& names() const { return layout_.names; }
  size_t columns() const { return layout_.columns; }

  size_t rows() const { return rows_.size(); }
  /// "file:line" of a row.
  std::string place(size_t row) const { return file_.string() + ":" + std::to_string(lines_[row]); }

  /// Index of a column by its name (or its number from 1). Throws Error with the columns that are there.
  size_t column(const std::string& name) const { return column_of(layout_, name, file_); }
  /// The same for a column that need not be there; one asked for by another name than `usual` must be. Empty name: none.
  std::optional<size_t> column_if_there(const std::string& name, const std::string& usual) const;

  const std::string& text(size_t row, size_t column) const { return rows_[row][column]; }
  /// The field with its decimal comma, where the table has them, as a point.
  std::string pointed(size_t row, size_t column) const;
  /// Throws Error with "file:line" where the field is empty: "`of` has no name".
  const std::string& name(size_t row, size_t column, const std::string& of) const;
  /// A whole number of up to nine digits; throws Error with "file:line": "`what` is not a whole number: 2.5".
  int whole_number(size_t row, size_t column, const std::string& what) const;
  /// Throws Error with "file:line" where the field is empty or no finite number.
  double number(size_t row, size_t column) const;
  /// The same of a number that may be infinite or none ("nan", or an empty field).
  double coordinate(size_t row, size_t column) const;

 private:
  std::string column_name(size_t column) const;

  std::filesystem::path file_;
  DelimitedLayout layout_;
  std::vector<std::vector<std::string>> rows_;
  std::vector<std::uint64_t> lines_;
};

}  // namespace swath::io
