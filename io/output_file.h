// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string_view>

namespace swath::io {

/// An output that appears whole or not at all: written under a temporary name in the same folder, flushed to disk,
/// renamed by commit(). Without commit() the temporary file is removed. Any failure is one clear core::Error
/// (folder not writable, disk full) that names the final file.
class OutputFile {
 public:
  explicit OutputFile(std::filesystem::path final_name);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// The name to write to, for libraries that open files themselves.
  const std::filesystem::path& temporary() const { return temporary_; }
  /// Flushes to disk and renames. Throws core::Error. Intermediate results pass `flush` = false: they survive a killed
  /// process, not a power failure, and a run can make them again.
  void commit(bool flush = true);

 private:
  std::filesystem::path final_, temporary_;
  bool committed_ = false;
};

/// Writes a small file through OutputFile.
void write_text_file(const std::filesystem::path& file, std::string_view text, bool flush = true);

/// core::Error for a failed system call on `file` by errno: names the reason, with a hint for a full disk or missing rights.
[[noreturn]] void throw_system_error(std::string_view doing, const std::filesystem::path& file, int code);

}  // namespace swath::io
