// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "io/text/binary_file.h"

namespace swath::io {

/// Streams the lines of a file that may hold anything between them. A stretch without a line end is cut every 64 KiB.
class LineReader {
 public:
  explicit LineReader(const std::filesystem::path& file);
  /// The next line without its end (LF or CR LF); valid until the next call. False at the end of the file.
  bool next(std::string_view& line);
  /// "file:line" of the line that next() gave last, from 1.
  std::string place() const;
  /// Its number.
  std::uint64_t number() const { return line_; }

 private:
  BinaryFile file_;
  std::vector<char> buffer_;
  size_t begin_ = 0, fill_ = 0;
  std::uint64_t file_at_ = 0, line_ = 0;
};

/// The parts of a line between runs of blanks, tabs, commas and semicolons.
std::vector<std::string_view> words_of(std::string_view line);
/// A number that is the whole text; false otherwise. "nan" and "inf" are numbers.
bool read_number(std::string_view text, double& value);

}  // namespace swath::io
