// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace swath::io {

/// An output that appears whole or not at all: written under a temporary name in the same folder, flushed to disk,
/// renamed by commit(). Without commit() the temporary file is removed. Any failure is one clear core::Error
/// (folder not writable, disk full) that names the final file. Not flushed while an UnflushedFiles lives on this thread.
class OutputFile {
 public:
  explicit OutputFile(std::filesystem::path final_name);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// The name to write to, for libraries that open files themselves.
  const std::filesystem::path& temporary() const { return temporary_; }
  /// Flushes to disk (see UnflushedFiles) and renames. Throws core::Error.
  void commit();

 private:
  std::filesystem::path final_, temporary_;
  bool committed_ = false;
};

/// How temporary names begin.
constexpr const char* temporary_mark = ".part-";

/// Has the file a temporary name? It belongs to a process that is at work or was killed: others must not read it.
bool is_temporary(const std::filesystem::path& file);

/// Writes a small file through OutputFile.
void write_text_file(const std::filesystem::path& file, std::string_view text);

/// A file, or a folder's list of names, as the disk keeps it. Throws core::SystemError.
void flush_to_disk(const std::filesystem::path& file);

/// While it lives, OutputFile on this thread leaves the flush to the system: for files that are checked before they are used again.
class UnflushedFiles {
 public:
  UnflushedFiles();
  ~UnflushedFiles();
  UnflushedFiles(const UnflushedFiles&) = delete;
  UnflushedFiles& operator=(const UnflushedFiles&) = delete;
};

/// The files that OutputFile finishes on this thread while the object lives; of nested ones the innermost gets them.
class FinishedFiles {
 public:
  /// `then`: called with each, once it has its name.
  explicit FinishedFiles(std::function<void(const std::filesystem::path&)> then = {});
  ~FinishedFiles();
  FinishedFiles(const FinishedFiles&) = delete;
  FinishedFiles& operator=(const FinishedFiles&) = delete;

  const std::vector<std::filesystem::path>& files() const { return files_; }

 private:
  friend class OutputFile;
  FinishedFiles* outer_;
  std::function<void(const std::filesystem::path&)> then_;
  std::vector<std::filesystem::path> files_;
};

/// core::SystemError where a library could not write `file` and says why in words alone, with the same hints.
[[noreturn]] void throw_write_error(const std::string& what, const std::filesystem::path& file);

/// core::Error for a failed system call on `file` by errno: names the reason, with a hint for a full disk or missing rights.
[[noreturn]] void throw_system_error(std::string_view doing, const std::filesystem::path& file, int code);

}  // namespace swath::io
