// SPDX-License-Identifier: GPL-3.0-or-later
// Reading a tile's points: whole, with those around it, in parts, or from the first to the last.
#include <algorithm>
#include <cmath>
#include <list>
#include <type_traits>
#include <utility>

#include "pipeline/tile_store.h"
#include "pipeline/work/store_file.h"

namespace swath::pipeline {
namespace {

namespace fs = std::filesystem;
using core::Block;
using core::Column;
using core::ColumnSet;

constexpr ColumnSet always{Column::x, Column::y, Column::z};
constexpr double thinned_at_once = 64.0;  // m, whole ones: thin() may keep one point of each square metre

/// The columns `mine` of an overlay's `rows` points.
void read_overlay(const fs::path& name, Block& to, ColumnSet mine, size_t rows) {
  StoreFile file(name, StoreFile::Mode::read);
  size_t row = 0;
  ColumnSet seen;
  while (row <= rows && read_chunk(file, to, row, mine, seen)) {
  }
  if (row != rows || !(mine - seen).empty()) throw damaged_work(name);
}

/// Calls f(rows of the chunk, number of the first of them) for each chunk of an overlay of `rows` points from `origin`.
template <class F>
void each_chunk(const fs::path& name, const Eigen::Vector3d& origin, ColumnSet mine, size_t rows, F&& f) {
  StoreFile file(name, StoreFile::Mode::read);
  for (size_t first = 0;;) {
    Block part;
    part.origin = origin;
    size_t n = 0;
    ColumnSet seen;
    if (!read_chunk(file, part, n, mine, seen)) {
      if (first != rows) throw damaged_work(name);
      return;
    }
    if (!(mine - seen).empty()) throw damaged_work(name);
    f(part, first, n);
    first += n;
  }
}

/// The elements at `which` become those of `to` from `at` on.
template <class V>
void gather(V& to, size_t at, const V& from, const std::vector<std::uint32_t>& which) {
  to.resize(at + which.size());
  for (size_t i = 0; i < which.size(); ++i) to[at + i] = from[which[i]];
}

/// The columns `mine` of an overlay of `rows` points at the rows `chosen` become those of `out` behind the first `before` points.
void append_chosen(const fs::path& name, ColumnSet mine, size_t rows, const std::vector<std::uint32_t>& chosen, size_t before, Block& out) {
  size_t next = 0;
  std::vector<std::uint32_t> here;
  each_chunk(name, out.origin, mine, rows, [&](const Block& part, size_t first, size_t n) {
    here.clear();
    const size_t at = before + next;
    for (; next < chosen.size() && chosen[next] < first + n; ++next) here.push_back(chosen[next] - static_cast<std::uint32_t>(first));
    core::for_each_column([&](Column c, std::string_view, auto member) {
      if (mine.has(c)) gather(out.*member, at, part.*member, here);
    });
  });
}

}  // namespace

Block TileStore::read(TileKey key, ColumnSet columns) const { return read(key, columns, 0); }

Block TileStore::read(TileKey key, ColumnSet columns, size_t more) const {
  Block out;
  out.origin = origin_;
  const auto at = tiles_.find(key);
  if (at == tiles_.end()) return out;
  columns = columns | always;
  const Overlays overlays = overlays_of(key, columns);
  const ColumnSet from_strips = columns - overlays.columns;
  core::for_each_column([&](Column c, std::string_view, auto member) {
    if (columns.has(c) && columns_.has(c)) (out.*member).reserve(at->second + more);
  });
  if (columns.has(Column::source)) out.source.bytes.reserve((at->second + more) * source_width_);
  ColumnSet seen;
  size_t row = 0;
  for (const Segment& s : segments_.at(key)) {
    StoreFile file(s.file, StoreFile::Mode::read);
    while (read_chunk(file, out, row, from_strips, seen)) {
    }
  }
  expect_whole(key, row);
  for (const auto& [file_name, mine] : overlays.files) {
    read_overlay(file_name, out, mine, row);
  }
  // A column that only some of the strips have is zero in the others.
  core::for_each_column([&](Column c, std::string_view, auto member) {
    if (columns.has(c) && columns_.has(c) && ((seen.has(c) && from_strips.has(c)) || overlays.columns.has(c))) (out.*member).resize(row);
  });
  if (!out.source.empty()) out.source.resize(row, 0);
  return out;
}

namespace {

/// The rows of an overlay one after the other.
class OverlayRows {
 public:
  OverlayRows(fs::path name, const Eigen::Vector3d& origin, ColumnSet columns)
      : name_(std::move(name)), columns_(columns), file_(name_, StoreFile::Mode::read) {
    chunk_.origin = origin;
  }
  /// The next `n` rows become those of `to` from `row` on.
  void take(size_t n, Block& to, size_t row) {
    for (size_t left = n; left > 0;) {
      if (at_ == rows_) {
        at_ = rows_ = 0;
        ColumnSet seen;
        if (!read_chunk(file_, chunk_, rows_, columns_, seen) || !(columns_ - seen).empty()) throw damaged_work(name_);
        continue;
      }
      const size_t m = std::min(left, rows_ - at_);
      core::for_each_column([&](Column c, std::string_view, auto member) {
        if (!columns_.has(c)) return;
        (to.*member).resize(row + m);
        std::copy_n((chunk_.*member).data() + at_, m, (to.*member).data() + row);
      });
      at_ += m, row += m, left -= m;
    }
  }

 private:
  fs::path name_;
  ColumnSet columns_;
  StoreFile file_;
  Block chunk_;
  size_t at_ = 0, rows_ = 0;
};

}  // namespace

void TileStore::each_rows(TileKey key, ColumnSet columns, const std::function<void(Block&)>& f) const {
  const auto at = tiles_.find(key);
  if (at == tiles_.end()) return;
  columns = columns | always;
  const Overlays overlays = overlays_of(key, columns);
  const ColumnSet from_strips = columns - overlays.columns;
  ColumnSet there = overlays.columns;  // of the tile: columns that only some of the strips have are zero in the others
  size_t width = 0;
  for (const Segment& s : segments_.at(key)) {
    StoreFile file(s.file, StoreFile::Mode::read);
    for (ChunkHead head{}; file.next(head); skip_chunk(file, head)) {
      for (int c = 0; c < core::column_count; ++c)
        if (const auto column = static_cast<Column>(c); head.set().has(column) && from_strips.has(column)) there.add(column);
      width = std::max<size_t>(width, head.source_width);
    }
  }
  std::list<OverlayRows> rows_of_overlays;
  for (const auto& [name, mine] : overlays.files) rows_of_overlays.emplace_back(name, origin_, mine);
  Block part;
  size_t rows = 0, all = 0;
  const auto give = [&] {
    if (rows == 0) return;
    all += rows;
    for (OverlayRows& o : rows_of_overlays) o.take(rows, part, 0);
    core::for_each_column([&](Column c, std::string_view, auto member) {
      if (there.has(c)) (part.*member).resize(rows);
    });
    if (there.has(Column::source)) part.source.resize(rows, width);
    f(part);
    part = {};
    part.origin = origin_;
    rows = 0;
  };
  part.origin = origin_;
  for (const Segment& s : segments_.at(key)) {
    StoreFile file(s.file, StoreFile::Mode::read);
    for (ColumnSet seen; read_chunk(file, part, rows, from_strips, seen);)
      if (rows >= rows_at_once / 2) give();
  }
  give();
  expect_whole(key, all);
}

void TileStore::append_where(Block& out, TileKey key, ColumnSet columns, const Wanted& wanted,
                             std::vector<std::uint32_t>* rows_of_tile) const {
  columns = columns | always;
  const Overlays overlays = overlays_of(key, columns);
  const ColumnSet from_strips = columns - overlays.columns;
  std::vector<std::uint32_t> chosen, rows;  // within the tile, within the chunk
  // Rows of the files that points came from go to writers, which have no halo.
  if (overlays.columns.has(Column::x) || overlays.columns.has(Column::y) || (columns.has(Column::source) && source_width_ > 0)) {
    const Block all = read(key, columns);
    for (std::uint32_t i = 0; i < all.size(); ++i)
      if (wanted(origin_.x() + all.x[i], origin_.y() + all.y[i])) rows.push_back(i);
    if (rows_of_tile) *rows_of_tile = rows;
    return core::append(out, all, rows);
  }
  const size_t before = out.size();
  size_t row = 0;
  std::vector<double> x, y;
  for (const Segment& s : segments_.at(key)) {
    StoreFile file(s.file, StoreFile::Mode::read);
    for (ChunkHead head{}; file.next(head); row += head.points) {
      if (origin_.x() + head.x1 < wanted.box.x0 || origin_.x() + head.x0 >= wanted.box.x1 || origin_.y() + head.y1 < wanted.box.y0 ||
          origin_.y() + head.y0 >= wanted.box.y1) {
        skip_chunk(file, head);
        continue;
      }
      const size_t at = before + chosen.size(), n = head.points;
      const ColumnSet there = head.set();
      core::for_each_column([&](Column c, std::string_view, auto member) {
        using T = typename std::remove_reference_t<decltype(out.*member)>::value_type;
        if (!there.has(c)) return;
        // x and y come first and decide which rows are wanted.
        const bool is_place = c == Column::x || c == Column::y;
        if (!is_place && (rows.empty() || !from_strips.has(c))) return file.skip_packed();
        std::vector<T> own;
        std::vector<T>* column = &own;
        if constexpr (std::is_same_v<T, double>) column = c == Column::x ? &x : c == Column::y ? &y : &own;
        column->resize(n);
        file.read_packed(column->data(), n, sizeof(T));
        if (c == Column::y) {
          rows.clear();
          for (std::uint32_t i = 0; i < n; ++i)
            if (wanted(origin_.x() + x[i], origin_.y() + y[i])) rows.push_back(i);
          gather(out.x, at, x, rows);
        }
        if (c != Column::x) gather(out.*member, at, *column, rows);
      });
      if (there.has(Column::source)) file.skip_packed();
      for (const std::uint32_t i : rows) chosen.push_back(static_cast<std::uint32_t>(row) + i);
    }
  }
  expect_whole(key, row);
  for (const auto& [file_name, mine] : overlays.files)
    if (!chosen.empty()) append_chosen(file_name, mine, row, chosen, before, out);
  // A column that only some of the points have is zero in the others.
  core::for_each_column([&](Column, std::string_view, auto member) {
    if (!(out.*member).empty()) (out.*member).resize(out.size());
  });
  if (rows_of_tile) *rows_of_tile = std::move(chosen);
}

void TileStore::append_around(Block& out, const TileBox& tiles, const stages::Box& box, ColumnSet columns,
                              const std::function<void(Block&)>& thin, const std::function<bool(double, double)>& own) const {
  const auto tile = [&](double edge) { return static_cast<int>(std::floor(edge / side_)); };
  for (int iy = tile(box.y0); iy <= tile(box.y1); ++iy)
    for (int ix = tile(box.x0); ix <= tile(box.x1); ++ix) {
      const bool is_own = tiles.holds({ix, iy});
      if (!tiles_.contains({ix, iy}) || (is_own && !own)) continue;
      Wanted wanted{box};
      if (is_own) wanted.chosen = [&own](double x, double y) { return !own(x, y); };
      if (!thin) {
        append_where(out, {ix, iy}, columns, wanted);
        continue;
      }
      // Thinned in stripes: few of the points are there before they are thinned.
      const double south = std::max(box.y0, iy * side_), north = std::min(box.y1, (iy + 1) * side_);
      for (double y = std::floor(south / thinned_at_once) * thinned_at_once; y < north; y += thinned_at_once) {
        wanted.box.y0 = y <= iy * side_ ? box.y0 : std::max(box.y0, y);
        wanted.box.y1 = y + thinned_at_once >= (iy + 1) * side_ ? box.y1 : std::min(box.y1, y + thinned_at_once);
        Block part;
        part.origin = origin_;
        append_where(part, {ix, iy}, columns, wanted);
        if (part.size() == 0) continue;
        thin(part);
        core::append(out, part);
      }
    }
}

Block TileStore::read_with_halo(const std::vector<TileKey>& keys, double halo, ColumnSet columns, size_t& own,
                                const std::function<void(Block&)>& thin, std::uint64_t rows) const {
  const TileBox tiles(keys);
  size_t more = 0;
  for (const TileKey k : keys)
    if (const auto at = tiles_.find(k); at != tiles_.end()) more += at->second;
  if (const auto at = tiles_.find(keys[0]); at != tiles_.end()) more -= at->second;
  more = std::max<size_t>(more, rows);
  Block out = read(keys[0], columns, more);
  for (size_t k = 1; k < keys.size(); ++k) core::append(out, read(keys[k], columns));
  own = out.size();
  if (halo > 0.0) append_around(out, tiles, tiles.metres(side_).grown(halo), columns, thin, {});
  return out;
}

Block TileStore::read_part(const TilePart& part, double halo, ColumnSet columns, std::vector<std::uint32_t>& rows,
                           const std::function<void(Block&)>& thin, std::uint64_t expected) const {
  Block out;
  out.origin = origin_;
  core::for_each_column([&](Column c, std::string_view, auto member) {
    if ((columns | always).has(c) && columns_.has(c)) (out.*member).reserve(expected);
  });
  const auto own = [&](double x, double y) { return part.holds(x, y, side_); };
  const stages::Box box = part.metres(side_);
  rows.clear();
  if (tiles_.contains(part.tile)) append_where(out, part.tile, columns, {box.grown(1.0), own}, &rows);  // wider than a rounding
  append_around(out, TileBox(part.tile, part.tile), box.grown(halo), columns, thin, own);
  return out;
}

}  // namespace swath::pipeline
