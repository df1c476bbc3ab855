// SPDX-License-Identifier: GPL-3.0-or-later
// Rows of chosen columns of a text or NumPy file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "io/survey/navigation.h"

namespace swath::io {

/// Streams rows of numbers.
class TableRows {
 public:
  virtual ~TableRows() = default;
  /// The next row's values in the order of the columns; false at the end. An empty field of a text is NaN.
  virtual bool next(double* values) = 0;
  /// Line, or number from 0, of the row that next() gave last.
  virtual std::uint64_t number() const = 0;
  /// "file:line" or "file: record N" of a row's number.
  virtual std::string place_of(std::uint64_t number) const = 0;
  std::string place() const { return place_of(number()); }
  /// Number of a line before the first row that is cut off and left out; 0: none.
  virtual std::uint64_t cut_line() const { return 0; }
};

/// Opens a table. `columns`: names, or numbers from 1. Throws Error: a column that is not there, a format that is not known.
std::unique_ptr<TableRows> open_table(const std::filesystem::path& file, RecordFormat format, const std::string& delimiter,
                                      const std::vector<std::string>& columns);

}  // namespace swath::io
