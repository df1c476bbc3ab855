// SPDX-License-Identifier: GPL-3.0-or-later
// Delimited text as numbers, streamed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "io/text/binary_file.h"
#include "io/text/fields.h"
#include "io/text/text_faults.h"

namespace swath::io {

/// How a delimited file is written, found in its first lines.
struct DelimitedLayout {
  char delimiter = ',';            ///< ',', ';', '\t', or ' ' for any run of blanks and tabs
  std::vector<std::string> names;  ///< the header's names; empty where there is none
  size_t columns = 0;              ///< fields of the first data line (0: no data line)
  size_t misfit = 0;               ///< fields of the first data lines where the header has another number of names; 0: it fits them
  std::uint64_t data_begin = 0;    ///< byte of the first data line
  std::uint64_t data_line = 1;     ///< its number, from 1
  bool decimal_comma = false;      ///< numbers have decimal commas (io/text/decimal_comma.h)
  std::uint64_t cut_line = 0;      ///< the line before it, where that is the end of a record only (io/text/cut_line.h); 0: none
};

/// Reads the first lines: byte order mark, comments (# or %), header, first data line. A header is a first line with a field that is
/// no number, unless the next line has texts and numbers in the same fields; or, where there is none, the last comment with as many words
/// as the data have fields. A description above the header, and units below it, are passed over (io/text/table_start.h), as is a first line
/// of data that is cut off. `delimiter`: "," ";" "tab" "\t" "blank" " ", or "" to find it in the first data line. Throws Error where the
/// file has no data line.
DelimitedLayout inspect_delimited(const std::filesystem::path& file, const std::string& delimiter = {});

/// Index from 0 of the column that a survey names: the header's name (letter case matters only where two names differ by it alone),
/// or a number from 1. Throws Error naming the file, the columns that exist and the nearest name; and, for a name, where the header has
/// more or fewer names than the data have fields, for then none says which column is whose.
size_t column_of(const DelimitedLayout& layout, const std::string& column, const std::filesystem::path& file);

/// Streams the numbers of chosen columns. Comments and empty lines are passed over. "nan" and "inf" are handed over as such, an empty
/// field as NaN; decimal commas are read where the layout has them, and a decimal point is a fault there. Throws Error "file:line" for a
/// field that is no number, for a line with too few fields, and for one with more fields than the header (without one, the first line of
/// data) where a character parts them: a decimal comma would move all that follows by one column.
class DelimitedReader {
 public:
  /// Reads from byte `begin` (start of line number `line`) to byte `end`. `columns`: indices from 0, in the order wanted.
  DelimitedReader(const std::filesystem::path& file, const DelimitedLayout& layout, std::vector<size_t> columns);
  DelimitedReader(const std::filesystem::path& file, const DelimitedLayout& layout, std::vector<size_t> columns, std::uint64_t begin,
                  std::uint64_t line, std::uint64_t end = std::numeric_limits<std::uint64_t>::max());

  /// The next data line's values; false at the end.
  bool next(double* values);
  /// Number from 1 and first byte of the line that next() gave last.
  std::uint64_t line() const { return line_; }
  std::uint64_t offset() const { return offset_; }

 private:
  bool next_line(const char*& begin, const char*& end);
  /// Throws Error where the file ends within the line [at, end), after which no line end follows.
  void expect_whole(const char* at, const char* end) const;
  [[noreturn]] void short_line(size_t fields) const;
  /// `at`: behind the fields that are needed.
  void expect_no_more(const char* at, const char* end) const;
  /// The same of lines parted by blanks, where an empty field moves all that follow it.
  void expect_all(const char* at, const char* end) const;
  /// A field by the table's decimal sign; false where it is no number.
  bool parse_field(const char* begin, const char* end, double& value) const;
  [[noreturn]] void bad_number(const char* begin, const char* end, size_t column) const;

  BinaryFile file_;
  std::vector<std::string> names_;
  char delimiter_;
  bool decimal_comma_;
  size_t fields_needed_, columns_;
  size_t fields_of_all_;                    // that a line has at least
  std::vector<std::vector<size_t>> slots_;  // per field of the line: places in `values`
  std::vector<char> buffer_;
  size_t begin_ = 0, fill_ = 0;  // unread part of the buffer
  std::uint64_t file_at_, end_;  // next byte to load; end of the stretch
  std::uint64_t next_offset_, next_line_;
  std::uint64_t offset_ = 0, line_ = 0;
  bool is_open_ = false;  // no line end follows the line
};

}  // namespace swath::io
