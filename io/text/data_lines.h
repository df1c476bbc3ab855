// SPDX-License-Identifier: GPL-3.0-or-later
// Short texts whose fields are names as well as numbers: logs, lists, tables of control.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace swath::io {

/// One line of data: its fields as texts, with its place for errors.
struct DataLine {
  std::string place;  ///< "file:line"
  std::uint64_t line = 0;
  std::vector<std::string> fields;

  [[noreturn]] void fault(const std::string& what, const std::string& hint) const;
  /// Throws Error where the line has fewer fields.
  const std::string& field(size_t column) const;
  /// Throws Error where the line has not as many fields as the header, or the first line, has columns.
  void expect_columns(size_t columns, bool has_header = true) const;
  /// Throws Error where the line has more fields; an empty last one is the delimiter at the line's end.
  void expect_at_most(size_t columns, bool has_header) const;
  /// Throws Error where the field is no finite number.
  double number(size_t column) const;
};

/// A whole file whose lines end in '\n', or in "\r\n": without its byte order mark; those of the classic Mac OS ended in '\r'. Throws Error
/// where it is not text.
std::string read_lines(const std::filesystem::path& file);

/// Calls f for every line that is neither empty nor a comment (# or %), and `comment` with the text of comments. `delimiter`: from the
/// first line of data. Throws Error where the file is not text.
void for_each_data_line(const std::filesystem::path& file, const std::function<char(const std::string&)>& delimiter,
                        const std::function<void(DataLine&)>& f, const std::function<void(const std::string&)>& comment = {});

}  // namespace swath::io
