// SPDX-License-Identifier: GPL-3.0-or-later
// The one format of points in the work folder: chunks of {ChunkHead, columns in the order of the enum, each packed
// (io/text/packed_column.h)}, in the machine's own byte order: the store is never carried elsewhere.
#pragma once

#include <cstdint>
#include <filesystem>

#include "core/block.h"
#include "io/text/packed_column.h"
#include "pipeline/work/checksum.h"

namespace swath::pipeline {

constexpr size_t chunk_rows = 1u << 16;  ///< of a chunk at most: what a reader holds at once is small whatever is in the file
constexpr size_t widest_row = 1u << 17;  ///< bytes, of the column `source`

/// Columns as bits of a ChunkHead.
std::uint32_t bits_of(core::ColumnSet set);

struct ChunkHead {
  std::uint32_t points = 0, columns = 0, source_width = 0, unused = 0;
  double x0 = 0, y0 = 0, x1 = 0, y1 = 0;  ///< around the points, where there are columns x and y
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
  /// The head of the next chunk; false at the end of the file.
  bool next(ChunkHead& head);
  void read(void* data, size_t n);
  void skip(size_t n);
  /// The next column: `n` values of `width` bytes.
  void read_packed(void* values, size_t n, size_t width);
  void skip_packed();
  /// Of a file that was written: a network disk may fail only here.
  void close();

 private:
  size_t read_some(void* data, size_t n);
  std::filesystem::path name_;
  int fd_;
  Checksum* checksum_;
  std::string packed_;
  std::uint64_t written_ = 0, size_ = 0, at_ = 0;
};

/// Writes rows as one chunk or several; one without points where there are none. `fields`: of the column `source` (io::fields_of_rows).
void write_chunks(StoreFile& file, const core::Block& block, size_t first, size_t count, core::ColumnSet columns,
                  const std::vector<std::uint8_t>& fields = {});

/// Appends the wanted columns of the next chunk to `to` at row `row`; false at the end of the file. `seen`: gets the chunk's columns.
bool read_chunk(StoreFile& file, core::Block& to, size_t& row, core::ColumnSet wanted, core::ColumnSet& seen);

/// The wanted columns behind a head become those of `to` from row `row` on; it grows where it has fewer rows.
void read_columns(StoreFile& file, const ChunkHead& head, core::Block& to, size_t row, core::ColumnSet wanted);
/// Passes over the columns behind a head.
void skip_chunk(StoreFile& file, const ChunkHead& head);

}  // namespace swath::pipeline
