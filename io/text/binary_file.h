// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

namespace swath::io {

/// What to name in place of a folder: its survey.toml where it has one.
std::string hint_of_folder(const std::filesystem::path& folder);

/// A regular file read at stated bytes. One object may be used by several threads.
class BinaryFile {
 public:
  /// Throws core::Error where the file cannot be opened, is a folder or no regular file.
  explicit BinaryFile(std::filesystem::path file);
  ~BinaryFile();
  BinaryFile(const BinaryFile&) = delete;
  BinaryFile& operator=(const BinaryFile&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::uint64_t size() const { return size_; }

  /// Fills `to` with exactly n bytes from byte `at`; throws core::Error "file: byte N" where the file ends before.
  void read(std::uint64_t at, void* to, size_t n) const;
  /// As read(), but up to n bytes: the number that the file still has.
  size_t read_some(std::uint64_t at, void* to, size_t n) const;

 private:
  std::filesystem::path path_;
  int fd_ = -1;
  std::uint64_t size_ = 0;
};

/// The value of type T stored at `p`, unaligned, in the stated byte order.
template <class T>
T load(const unsigned char* p, bool big_endian = false) {
  unsigned char bytes[sizeof(T)];
  std::memcpy(bytes, p, sizeof(T));
  if (big_endian != (std::endian::native == std::endian::big)) std::reverse(bytes, bytes + sizeof(T));
  T value;
  std::memcpy(&value, bytes, sizeof(T));
  return value;
}

/// Stores a value unaligned, little-endian.
template <class T>
void store(unsigned char* p, T value) {
  std::memcpy(p, &value, sizeof(T));
  if constexpr (std::endian::native == std::endian::big) std::reverse(p, p + sizeof(T));
}

/// Appends whole buffers to a file that exists; for outputs under OutputFile's temporary name.
class BinaryAppender {
 public:
  /// `named`: the final name, for errors.
  BinaryAppender(const std::filesystem::path& file, std::filesystem::path named);
  ~BinaryAppender();
  BinaryAppender(const BinaryAppender&) = delete;
  BinaryAppender& operator=(const BinaryAppender&) = delete;

  /// Throws core::Error naming the file (disk full and the like).
  void append(const void* from, size_t n);
  /// Overwrites bytes already written.
  void rewrite(std::uint64_t at, const void* from, size_t n);
  void close();

 private:
  std::filesystem::path named_;
  int fd_ = -1;
  std::uint64_t size_ = 0;
};

}  // namespace swath::io
