// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/work/store_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/error.h"
#include "io/text/output_file.h"
#include "pipeline/work/piece_record.h"

namespace swath::pipeline {
namespace {

using core::Block;
using core::Column;
using core::ColumnSet;

bool is_coordinate(Column c) { return c == Column::x || c == Column::y || c == Column::z; }

}  // namespace

std::uint32_t bits_of(ColumnSet set) {
  std::uint32_t bits = 0;
  for (int c = 0; c < core::column_count; ++c)
    if (set.has(static_cast<Column>(c))) bits |= 1u << c;
  return bits;
}

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
  if (got != sizeof head || head.points > chunk_rows || head.source_width > widest_row) throw damaged_work(name_);
  return true;
}

void StoreFile::read(void* data, size_t n) {
  if (read_some(data, n) != n) throw damaged_work(name_);
}

void StoreFile::read_packed(void* values, size_t n, size_t width) {
  io::PackedHead head;
  read(&head, sizeof head);
  if (head.bytes > size_ - std::min(size_, at_)) throw damaged_work(name_);
  packed_.resize(head.bytes);
  read(packed_.data(), packed_.size());
  if (!io::unpack(head, packed_.data(), values, n, width)) throw damaged_work(name_);
}

void StoreFile::skip_packed() {
  io::PackedHead head;
  read(&head, sizeof head);
  if (head.bytes > size_ - std::min(size_, at_)) throw damaged_work(name_);
  skip(head.bytes);
}

void StoreFile::skip(size_t n) {
  if (::lseek(fd_, static_cast<off_t>(n), SEEK_CUR) < 0) io::throw_system_error("cannot read", name_, errno);
  at_ += n;
}

void StoreFile::close() {
  if (::close(std::exchange(fd_, -1)) && errno != EINTR) io::throw_system_error("cannot write", name_, errno);
}

void write_chunks(StoreFile& file, const Block& b, size_t first, size_t n, ColumnSet columns, const std::vector<std::uint8_t>& fields) {
  if (columns.has(Column::source) && b.source.width > widest_row)
    throw core::Error("records of " + std::to_string(b.source.width) + " bytes are longer than any format's", "");
  for (const size_t end = first + n; first < end || n == 0; first += n) {
    n = std::min(end - first, chunk_rows);
    ChunkHead head{static_cast<std::uint32_t>(n), bits_of(columns), static_cast<std::uint32_t>(b.source.width)};
    if (columns.has(Column::x) && columns.has(Column::y) && n > 0) {
      const auto at = [&](const std::vector<double>& v) { return v.begin() + static_cast<std::ptrdiff_t>(first); };
      const auto count = static_cast<std::ptrdiff_t>(n);
      const auto [west, east] = std::minmax_element(at(b.x), at(b.x) + count);
      const auto [south, north] = std::minmax_element(at(b.y), at(b.y) + count);
      head.x0 = *west, head.y0 = *south, head.x1 = *east, head.y1 = *north;
    }
    std::string bytes(reinterpret_cast<const char*>(&head), sizeof head);
    core::for_each_column([&](Column c, std::string_view, auto member) {
      if (!columns.has(c)) return;
      const auto* values = (b.*member).data() + first;
      if constexpr (std::is_same_v<decltype(values), const double*>)
        if (is_coordinate(c)) return io::pack_coordinates(values, n, bytes);
      io::pack(values, n, sizeof *values, bytes);
    });
    if (columns.has(Column::source)) io::pack_rows(b.source.row(first), n, b.source.width, fields, bytes);
    file.write(bytes.data(), bytes.size());
    if (n == 0) return;
  }
}

namespace {

/// The rows of the chunk's column `source`, behind its other columns, to row `row` of `to`; passed over where they are not wanted.
void read_source(StoreFile& file, const ChunkHead& head, bool wanted, core::ByteRows& to, size_t row) {
  if (!wanted) return file.skip_packed();
  to.resize(std::max(to.size(), row + head.points), head.source_width);
  if (to.width == head.source_width) return file.read_packed(to.row(row), head.points, head.source_width);
  std::vector<std::uint8_t> narrow(size_t{head.points} * head.source_width);
  file.read_packed(narrow.data(), head.points, head.source_width);
  for (size_t i = 0; i < head.points; ++i) std::copy_n(narrow.data() + i * head.source_width, head.source_width, to.row(row + i));
}

}  // namespace

void read_columns(StoreFile& file, const ChunkHead& head, Block& to, size_t row, ColumnSet wanted) {
  const ColumnSet there = head.set();
  core::for_each_column([&](Column c, std::string_view, auto member) {
    if (!there.has(c)) return;
    if (!wanted.has(c)) return file.skip_packed();
    auto& column = to.*member;
    if (column.size() < row + head.points) column.resize(row + head.points);
    file.read_packed(column.data() + row, head.points, sizeof column[0]);
  });
  if (there.has(Column::source)) read_source(file, head, wanted.has(Column::source), to.source, row);
}

bool read_chunk(StoreFile& file, Block& to, size_t& row, ColumnSet wanted, ColumnSet& seen) {
  ChunkHead head{};
  if (!file.next(head)) return false;
  seen = seen | head.set();
  read_columns(file, head, to, row, wanted);
  row += head.points;
  return true;
}

void skip_chunk(StoreFile& file, const ChunkHead& head) {
  const ColumnSet there = head.set();
  for (int c = 0; c < core::column_count; ++c)
    if (there.has(static_cast<Column>(c))) file.skip_packed();
}

}  // namespace swath::pipeline
