// SPDX-License-Identifier: GPL-3.0-or-later
// The one format of points in the work folder: chunks of {u32 points, u32 column bits, u32 bytes of a row of the column `source`, columns
// in the order of the enum}, in the machine's own byte order: the store is never carried elsewhere.
#pragma once

#include <cstdint>
#include <filesystem>

#include "core/block.h"
#include "pipeline/work/checksum.h"

namespace swath::pipeline {

struct ChunkHead {
  std::uint32_t points = 0, columns = 0, source_width = 0;
  core::ColumnSet set() const;
};

/// Throws core::SystemError: the disk is full, or the file is not as it was written.
class StoreFile {
 public:
  enum class Mode { read, append };
  /// `checksum`: gets what is written.
  StoreFile(std::filesystem::path name, Mode mode, Checksum* checksum = nullptr);
  ~StoreFile();
  StoreFile(const StoreFile&) = delete;
  StoreFile& operator=(const StoreFile&) = delete;

  void write(const void* data, size_t n);
  std::uint64_t written() const { return written_; }
  /// The head of the next chunk, of which the whole is there; false at the end of the file.
  bool next(ChunkHead& head);
  void read(void* data, size_t n);
  void skip(size_t n);
  /// Of a file that was written: a network disk may fail only here.
  void close();

 private:
  size_t read_some(void* data, size_t n);
  std::filesystem::path name_;
  int fd_;
  Checksum* checksum_;
  std::uint64_t written_ = 0, size_ = 0, at_ = 0;
};

void write_chunk(StoreFile& file, const core::Block& block, size_t first, size_t count, core::ColumnSet columns);

/// Appends the wanted columns of the next chunk to `to` at row `row`; false at the end of the file. `seen`: gets the chunk's columns.
bool read_chunk(StoreFile& file, core::Block& to, size_t& row, core::ColumnSet wanted, core::ColumnSet& seen);

}  // namespace swath::pipeline
