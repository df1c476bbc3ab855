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

/// The columns `mine` of an overlay are those of the rows `row` to `end` - 1.
void read_overlay(const fs::path& name, Block& to, ColumnSet mine, size_t row, size_t end) {
  StoreFile file(name, StoreFile::Mode::read);
  ColumnSet seen;
  while (row <= end && read_chunk(file, to, row, mine, seen)) {
  }
  if (row != end || !(mine - seen).empty()) throw damaged_work(name);
}

/// The elements at `which` become those of `to` from `at` on.
template <class V>
void gather(V& to, size_t at, const V& from, const std::vector<std::uint32_t>& which) {
  to.resize(at + which.size());
  for (size_t i = 0; i < which.size(); ++i) to[at + i] = from[which[i]];
}

}  // namespace

Block TileStore::read(TileKey key, ColumnSet columns) const {
  Block out;
  out.origin = origin_;
  append_tile(out, key, columns, 0);
  return out;
}

void TileStore::append_tile(Block& out, TileKey key, ColumnSet columns, std::uint64_t room) const {
  const auto at = tiles_.find(key);
  if (at == tiles_.end()) return;
  columns = columns | always;
  const Overlays overlays = overlays_of(key, columns);
  const ColumnSet from_strips = columns - overlays.columns;
  const size_t before = out.size();
  room = std::max(room, before + at->second);
  core::for_each_column([&](Column c, std::string_view, auto member) {
    if (columns.has(c) && columns_.has(c)) (out.*member).reserve(room);
  });
  if (columns.has(Column::source)) out.source.bytes.reserve(room * source_width_);
  ColumnSet seen;
  size_t row = before;
  for (const Segment& s : segments_.at(key)) {
    StoreFile file(s.file, StoreFile::Mode::read);
    while (read_chunk(file, out, row, from_strips, seen)) {
    }
  }
  expect_whole(key, row - before);
  for (const auto& [file_name, mine] : overlays.files) read_overlay(file_name, out, mine, before, row);
  // A column that only some of the strips have is zero in the others.
  core::for_each_column([&](Column c, std::string_view, auto member) {
    const bool is_there = (seen.has(c) && from_strips.has(c)) || overlays.columns.has(c) || !(out.*member).empty();
    if (columns.has(c) && columns_.has(c) && is_there) (out.*member).resize(row);
  });
  if (!out.source.empty()) out.source.resize(row, 0);
}

namespace {

/// The rows of an overlay one after the other; chunks of which none is wanted are not unpacked.
class OverlayRows {
 public:
  OverlayRows(fs::path name, const Eigen::Vector3d& origin, ColumnSet columns)
      : name_(std::move(name)), columns_(columns), file_(name_, StoreFile::Mode::read) {
    chunk_.origin = origin;
  }
  /// The next `n` rows become those of `to` from `row` on.
  void take(size_t n, Block& to, size_t row) {
    pass(n, [&](size_t, size_t m) {
      unpack();
      each_mine(to, [&](auto& column, const auto& mine) {
        column.resize(row + m);
        std::copy_n(mine.data() + at_, m, column.data() + row);
      });
      row += m;
    });
  }
  /// Of the next `n` rows those that are `chosen`, ascending, become those of `to` from `row` on.
  void take_chosen(size_t n, const std::vector<std::uint32_t>& chosen, Block& to, size_t row) {
    auto first = chosen.begin();
    pass(n, [&](size_t passed, size_t m) {
      const auto last = std::lower_bound(first, chosen.end(), passed + m);
      if (first == last) return;
      unpack();
      const auto count = static_cast<size_t>(last - first);
      each_mine(to, [&](auto& column, const auto& mine) {
        column.resize(row + count);
        for (size_t i = 0; i < count; ++i) column[row + i] = mine[at_ + first[static_cast<std::ptrdiff_t>(i)] - passed];
      });
      row += count;
      first = last;
    });
  }
  void expect_end() {
    if (at_ < head_.points) throw damaged_work(name_);
    next();
    if (head_.points > 0) throw damaged_work(name_);
  }

 private:
  /// Calls f(rows passed before, rows) for stretches of the next `n` rows, each of them within a chunk.
  template <class F>
  void pass(size_t n, F&& f) {
    for (size_t passed = 0; passed < n;) {
      if (at_ == head_.points) {
        next();
        if (head_.points == 0) throw damaged_work(name_);
        continue;
      }
      const size_t m = std::min<size_t>(n - passed, head_.points - at_);
      f(passed, m);
      at_ += m, passed += m;
    }
  }
  /// The head of the next chunk that has points; one without points at the end.
  void next() {
    do {
      if (!is_unpacked_) skip_chunk(file_, head_);
      at_ = 0;
      is_unpacked_ = false;
      head_ = {};
      if (!file_.next(head_)) {
        is_unpacked_ = true;
        return;
      }
      if (!(columns_ - head_.set()).empty()) throw damaged_work(name_);
    } while (head_.points == 0);
  }
  void unpack() {
    if (!is_unpacked_) read_columns(file_, head_, chunk_, 0, columns_);
    is_unpacked_ = true;
  }
  template <class F>
  void each_mine(Block& to, F&& f) const {
    core::for_each_column([&](Column c, std::string_view, auto member) {
      if (columns_.has(c)) f(to.*member, chunk_.*member);
    });
  }

  fs::path name_;
  ColumnSet columns_;
  StoreFile file_;
  Block chunk_;
  ChunkHead head_;
  size_t at_ = 0;
  bool is_unpacked_ = true;
};

/// Of a chunk those rows whose places are wanted(x, y), in the block's frame, become the last of `out`; `rows`: their numbers in the chunk.
class ChosenRows {
 public:
  template <class W>
  void take(StoreFile& file, const ChunkHead& head, ColumnSet columns, const W& wanted, std::vector<std::uint32_t>& rows, Block& out) {
    const size_t at = out.size(), n = head.points;
    const ColumnSet there = head.set();
    core::for_each_column([&](Column c, std::string_view, auto member) {
      using T = typename std::remove_reference_t<decltype(out.*member)>::value_type;
      if (!there.has(c)) return;
      // x and y come first and decide which rows are wanted.
      const bool is_place = c == Column::x || c == Column::y;
      if (!is_place && (rows.empty() || !columns.has(c))) return file.skip_packed();
      std::vector<T> own;
      std::vector<T>* column = &own;
      if constexpr (std::is_same_v<T, double>) column = c == Column::x ? &x_ : c == Column::y ? &y_ : &other_;
      column->resize(n);
      file.read_packed(column->data(), n, sizeof(T));
      if (c == Column::y) {
        rows.clear();
        for (std::uint32_t i = 0; i < n; ++i)
          if (wanted(x_[i], y_[i])) rows.push_back(i);
        gather(out.x, at, x_, rows);
      }
      if (c != Column::x) gather(out.*member, at, *column, rows);
    });
    if (there.has(Column::source)) file.skip_packed();
  }

 private:
  std::vector<double> x_, y_, other_;
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

void TileStore::append_where(Block& out, TileKey key, ColumnSet columns, const Wanted& wanted, std::vector<std::uint32_t>* rows_of_tile,
                             const std::function<void(Block&)>& grown) const {
  columns = columns | always;
  const Overlays overlays = overlays_of(key, columns);
  const ColumnSet from_strips = columns - overlays.columns;
  const auto is_wanted = [&](double x, double y) { return wanted(origin_.x() + x, origin_.y() + y); };
  std::vector<std::uint32_t> rows;  // within the chunk
  // Rows of the files that points came from go to writers, which have no halo.
  if (overlays.columns.has(Column::x) || overlays.columns.has(Column::y) || (columns.has(Column::source) && source_width_ > 0)) {
    const Block all = read(key, columns);
    for (std::uint32_t i = 0; i < all.size(); ++i)
      if (is_wanted(all.x[i], all.y[i])) rows.push_back(i);
    if (rows_of_tile) *rows_of_tile = rows;
    return core::append(out, all, rows);
  }
  std::list<OverlayRows> rows_of_overlays;
  for (const auto& [name, mine] : overlays.files) rows_of_overlays.emplace_back(name, origin_, mine);
  ChosenRows chosen;
  std::uint32_t row = 0;
  for (const Segment& s : segments_.at(key)) {
    StoreFile file(s.file, StoreFile::Mode::read);
    for (ChunkHead head{}; file.next(head); row += head.points) {
      const size_t before = out.size();
      rows.clear();
      if (origin_.x() + head.x1 < wanted.box.x0 || origin_.x() + head.x0 >= wanted.box.x1 || origin_.y() + head.y1 < wanted.box.y0 ||
          origin_.y() + head.y0 >= wanted.box.y1)
        skip_chunk(file, head);
      else
        chosen.take(file, head, from_strips, is_wanted, rows, out);
      for (OverlayRows& o : rows_of_overlays) o.take_chosen(head.points, rows, out, before);
      if (rows.empty()) continue;
      // A column that only some of the points have is zero in the others.
      core::for_each_column([&](Column, std::string_view, auto member) {
        if (!(out.*member).empty()) (out.*member).resize(out.size());
      });
      if (rows_of_tile)
        for (const std::uint32_t i : rows) rows_of_tile->push_back(row + i);
      if (grown) grown(out);
    }
  }
  expect_whole(key, row);
  for (OverlayRows& o : rows_of_overlays) o.expect_end();
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
      // Thinned again and again as it is read: few of the points are there at a time.
      Block part;
      part.origin = origin_;
      size_t most = thinned_at_once;
      append_where(part, {ix, iy}, columns, wanted, nullptr, [&](Block& b) {
        if (b.size() < most) return;
        thin(b);
        most = b.size() + thinned_at_once;
      });
      if (part.size() == 0) continue;
      thin(part);
      core::append(out, part);
    }
}

Block TileStore::read_with_halo(const std::vector<TileKey>& keys, double halo, ColumnSet columns, size_t& own,
                                const std::function<void(Block&)>& thin, std::uint64_t rows) const {
  const TileBox tiles(keys);
  Block out;
  out.origin = origin_;
  std::uint64_t of_tiles = 0;
  for (const TileKey k : keys)
    if (const auto at = tiles_.find(k); at != tiles_.end()) of_tiles += at->second;
  for (const TileKey k : keys) append_tile(out, k, columns, std::max(of_tiles, rows));
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
