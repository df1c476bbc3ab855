// SPDX-License-Identifier: GPL-3.0-or-later
// One reader for local files and objects of stores.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>

namespace swath::io {

class StoredObject;

/// A file read at stated bytes; a name that is_address() is opened in its store, by ranges. One object is for one thread at a time.
class InputFile {
 public:
  /// Throws core::Error where it cannot be opened, is a folder or no regular file.
  explicit InputFile(std::filesystem::path file);
  ~InputFile();
  InputFile(InputFile&& other) noexcept;
  InputFile& operator=(InputFile&& other) noexcept;

  const std::filesystem::path& path() const { return path_; }
  std::uint64_t size() const { return size_; }

  /// Up to n bytes from byte `at`: the number that the file still has. Throws core::Error where it cannot be read.
  std::size_t read_some(std::uint64_t at, void* to, std::size_t n);

 private:
  std::filesystem::path path_;
  int fd_ = -1;
  std::unique_ptr<StoredObject> object_;
  std::uint64_t size_ = 0;
};

}  // namespace swath::io
