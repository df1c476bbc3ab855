// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/work/store_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <utility>
#include <vector>

#include "io/output_file.h"
#include "pipeline/work/piece_record.h"

namespace swath::pipeline {
namespace {

using core::Block;
using core::Column;
using core::ColumnSet;

std::uint32_t bits_of(ColumnSet set) {
  std::uint32_t bits = 0;
  for (int c = 0; c < core::column_count; ++c)
    if (set.has(static_cast<Column>(c))) bits |= 1u << c;
  return bits;
}

/// Of all columns of a chunk.
std::uint64_t bytes_of(const ChunkHead& head) {
  const ColumnSet there = head.set();
  std::uint64_t row = there.has(Column::source) ? head.source_width : 0;
  core::for_each_column([&](Column c, std::string_view, auto member) {
    if (there.has(c)) row += sizeof((std::declval<Block>().*member)[0]);
  });
  return row * head.points;
}

}  // namespace

ColumnSet ChunkHead::set() const {
  ColumnSet set;
  for (int c = 0; c < core::column_count; ++c)
    if ((columns >> c) & 1u) set.add(static_cast<Column>(c));
  return set;
}

StoreFile::StoreFile(std::filesystem::path name, Mode mode, Checksum* checksum) : name_(std::move(name)), checksum_(checksum) {
  fd_ = ::open(name_.c_str(), (mode == Mode::read ? O_RDONLY : O_WRONLY | O_CREAT | O_APPEND) | O_CLOEXEC, 0666);
  if (fd_ < 0 && mode == Mode::read && errno == ENOENT) throw damaged_work(name_);
  if (fd_ < 0) io::throw_system_error("cannot open", name_, errno);
  struct stat info {};
  if (mode == Mode::read && ::fstat(fd_, &info) == 0) size_ = static_cast<std::uint64_t>(info.st_size);
}

StoreFile::~StoreFile() {
  if (fd_ >= 0) ::close(fd_);
}

void StoreFile::write(const void* data, size_t n) {
  const char* at = static_cast<const char*>(data);
  for (size_t left = n; left > 0;) {
    const ssize_t done = ::write(fd_, at, left);
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) io::throw_system_error("cannot write", name_, errno);
    at += done;
    left -= static_cast<size_t>(done);
  }
  if (checksum_) checksum_->add(data, n);
  written_ += n;
}

size_t StoreFile::read_some(void* data, size_t n) {
  char* at = static_cast<char*>(data);
  size_t left = n;
  while (left > 0) {
    const ssize_t done = ::read(fd_, at, left);
    if (done < 0 && errno == EINTR) continue;
    if (done < 0) io::throw_system_error("cannot read", name_, errno);
    if (done == 0) break;
    at += done;
    left -= static_cast<size_t>(done);
  }
  at_ += n - left;
  return n - left;
}

bool StoreFile::next(ChunkHead& head) {
  const size_t got = read_some(&head, sizeof head);
  if (got == 0) return false;
  const std::uint64_t bytes = bytes_of(head);
  if (got != sizeof head || bytes > size_ - std::min(size_, at_) || bytes < head.points) throw damaged_work(name_);
  return true;
}

void StoreFile::read(void* data, size_t n) {
  if (read_some(data, n) != n) throw damaged_work(name_);
}

void StoreFile::skip(size_t n) {
  if (::lseek(fd_, static_cast<off_t>(n), SEEK_CUR) < 0) io::throw_system_error("cannot read", name_, errno);
  at_ += n;
}

void StoreFile::close() {
  if (::close(std::exchange(fd_, -1)) && errno != EINTR) io::throw_system_error("cannot write", name_, errno);
}

void write_chunk(StoreFile& file, const Block& b, size_t first, size_t n, ColumnSet columns) {
  const ChunkHead head{static_cast<std::uint32_t>(n), bits_of(columns), static_cast<std::uint32_t>(b.source.width)};
  file.write(&head, sizeof head);
  core::for_each_column([&](Column c, std::string_view, auto member) {
    if (columns.has(c)) file.write((b.*member).data() + first, n * sizeof((b.*member)[0]));
  });
  if (columns.has(Column::source)) file.write(b.source.row(first), n * b.source.width);
}

namespace {

/// The rows of the chunk's column `source`, behind its other columns, to row `row` of `to`; passed over where they are not wanted.
void read_source(StoreFile& file, const ChunkHead& head, bool wanted, core::ByteRows& to, size_t row) {
  const size_t bytes = size_t{head.points} * head.source_width;
  if (!wanted) return file.skip(bytes);
  to.resize(std::max(to.size(), row + head.points), head.source_width);
  if (to.width == head.source_width) {
    if (bytes > 0) file.read(to.row(row), bytes);
    return;
  }
  std::vector<std::uint8_t> narrow(bytes);
  if (bytes > 0) file.read(narrow.data(), bytes);
  for (size_t i = 0; i < head.points; ++i) std::copy_n(narrow.data() + i * head.source_width, head.source_width, to.row(row + i));
}

}  // namespace

bool read_chunk(StoreFile& file, Block& to, size_t& row, ColumnSet wanted, ColumnSet& seen) {
  ChunkHead head{};
  if (!file.next(head)) return false;
  const ColumnSet there = head.set();
  seen = seen | there;
  core::for_each_column([&](Column c, std::string_view, auto member) {
    if (!there.has(c)) return;
    auto& column = to.*member;
    const size_t bytes = head.points * sizeof(column[0]);
    if (!wanted.has(c)) return file.skip(bytes);
    if (column.size() < row + head.points) column.resize(row + head.points);
    if (bytes > 0) file.read(column.data() + row, bytes);
  });
  if (there.has(Column::source)) read_source(file, head, wanted.has(Column::source), to.source, row);
  row += head.points;
  return true;
}

}  // namespace swath::pipeline
