// SPDX-License-Identifier: GPL-3.0-or-later
// File of a strip's points in one tile: chunks (store_file.h), one after the other. File of an overlay: one chunk.
#include "pipeline/tile_store.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <utility>

#include "core/config/value.h"
#include "core/error.h"
#include "core/floor_div.h"
#include "io/text/output_file.h"
#include "pipeline/work/store_file.h"

namespace swath::pipeline {
namespace {

namespace fs = std::filesystem;
using core::Block;
using core::Column;
using core::ColumnSet;

constexpr double farthest_tile = 1e8;  // m; beyond every map projection, and tile numbers stay in range
constexpr const char* strip_record = "strip.json";

std::string points_file(TileKey key) { return file_label(key) + ".pts"; }

core::Value strip_note(const fs::path& strip_folder) {
  std::optional<PieceRecord> record = read_record(strip_folder / strip_record);
  if (!record) throw damaged_work(strip_folder / strip_record);
  return std::move(record->note);
}

/// Around two boxes.
stages::Box joined(const stages::Box& a, const stages::Box& b) {
  return {std::min(a.x0, b.x0), std::min(a.y0, b.y0), std::max(a.x1, b.x1), std::max(a.y1, b.y1)};
}

double common_area(const stages::Box& a, const stages::Box& b) {
  const double width = std::min(a.x1, b.x1) - std::max(a.x0, b.x0), height = std::min(a.y1, b.y1) - std::max(a.y0, b.y0);
  return std::max(0.0, width) * std::max(0.0, height);
}

stages::Box extent_of(const Block& b) {
  const auto [west, east] = std::minmax_element(b.x.begin(), b.x.end());
  const auto [south, north] = std::minmax_element(b.y.begin(), b.y.end());
  return {b.origin.x() + *west, b.origin.y() + *south, b.origin.x() + *east, b.origin.y() + *north};
}

/// Of an entry of the note's list of tiles.
TileKey key_of(const core::Value& tile) { return {static_cast<int>(tile.items()[0].as_int()), static_cast<int>(tile.items()[1].as_int())}; }

}  // namespace

std::string file_label(TileKey k) { return std::to_string(k.ix) + "_" + std::to_string(k.iy); }

void keep_columns(Block& block, ColumnSet kept) {
  core::for_each_column([&](Column c, std::string_view, auto member) {
    if (!kept.has(c)) (block.*member) = {};
  });
  if (!kept.has(Column::source)) block.source = {};
}

StripWriter::StripWriter(fs::path folder, double tile_side, size_t buffer_bytes)
    : final_(std::move(folder)), part_(final_), tile_side_(tile_side), buffer_bytes_(buffer_bytes) {
  part_ += ".part";
  std::error_code ec;
  fs::remove_all(part_, ec);
  fs::create_directories(part_, ec);
  if (ec) io::throw_system_error("cannot make the folder", part_, ec.value());
}

StripWriter::~StripWriter() {
  if (committed_) return;
  std::error_code ignored;
  fs::remove_all(part_, ignored);
}

void StripWriter::write(const Block& block) {
  std::map<TileKey, std::vector<std::uint32_t>> rows;
  TileKey last{};
  std::vector<std::uint32_t>* at = nullptr;
  for (std::uint32_t i = 0; i < block.size(); ++i) {
    const double east = block.origin.x() + block.x[i], north = block.origin.y() + block.y[i];
    if (!(std::abs(east) < farthest_tile && std::abs(north) < farthest_tile && std::isfinite(block.z[i])))
      throw core::Error("a point lies at east " + core::format_number(east, 10) + " m, north " + core::format_number(north, 10) +
                            " m, height " + core::format_number(block.origin.z() + block.z[i], 8) + " m",
                        "line " + std::to_string(block.strip.empty() ? 0 : block.strip[i]) + ", record " +
                            std::to_string(block.record.empty() ? i : block.record[i]),
                        "no map projection reaches that far: is the file damaged, or its CRS another?");
    const TileKey key{static_cast<int>(core::floor_of(east / tile_side_)), static_cast<int>(core::floor_of(north / tile_side_))};
    if (!at || key != last) at = &rows[last = key];
    at->push_back(i);
  }
  size_t row_bytes = 0;
  const ColumnSet present = core::columns_of(block);
  core::for_each_column([&](Column c, std::string_view, auto member) {
    if (present.has(c)) row_bytes += sizeof((block.*member)[0]);
  });
  row_bytes += block.source.width;
  if (fields_.empty()) fields_ = io::fields_of_rows(block.source.row(0), block.source.size(), block.source.width);
  for (const auto& [key, mine] : rows) {
    Block& pending = pending_[key];
    pending.origin = block.origin;
    core::append(pending, block, mine);
    buffered_ += mine.size() * row_bytes;
    if (pending.size() >= 65536) {
      buffered_ -= std::min(buffered_, pending.size() * row_bytes);
      flush(key, pending);
    }
  }
  if (buffered_ > buffer_bytes_) {
    for (auto& [key, points] : pending_) flush(key, points);
    pending_.clear();
    buffered_ = 0;
  }
}

void StripWriter::flush(TileKey key, Block& points) {
  if (points.size() == 0) return;
  Written& written = written_[key];
  written.extent = written.points > 0 ? joined(written.extent, extent_of(points)) : extent_of(points);
  StoreFile file(part_ / points_file(key), StoreFile::Mode::append, &written.checksum);
  write_chunks(file, points, 0, points.size(), core::columns_of(points), fields_);
  file.close();
  columns_ = columns_ | core::columns_of(points);
  source_width_ = std::max(source_width_, points.source.width);
  written.points += points.size();
  written.bytes += file.written();
  core::Block fresh;
  fresh.origin = points.origin;
  points = std::move(fresh);
}

void StripWriter::commit(const std::string& note) {
  for (auto& [key, points] : pending_) flush(key, points);
  pending_.clear();
  PieceRecord record;
  core::Value::Array tiles;
  for (const auto& [key, written] : written_) {
    const stages::Box& e = written.extent;
    tiles.emplace_back(core::Value::Array{key.ix, key.iy, written.points, e.x0, e.y0, e.x1, e.y1});
    record.files.push_back({points_file(key), written.bytes, written.checksum.text()});
  }
  record.note =
      core::Value::Object{{"note", note}, {"columns", bits_of(columns_)}, {"source_width", source_width_}, {"tiles", std::move(tiles)}};
  const io::UnflushedFiles checked_when_resumed;
  write_record(part_ / strip_record, final_ / strip_record, record);
  std::error_code ec;
  fs::remove_all(final_, ec);
  fs::rename(part_, final_, ec);
  if (ec) io::throw_system_error("cannot finish", final_, ec.value());
  committed_ = true;
}

TileStore::TileStore(fs::path strips, double tile_side, const Eigen::Vector3d& origin)
    : strips_(std::move(strips)), side_(tile_side), origin_(origin) {}

bool TileStore::is_committed(const fs::path& strip_folder) { return fs::exists(strip_folder / strip_record); }

std::string TileStore::note(const fs::path& strip_folder) { return strip_note(strip_folder).find("note")->as_text(); }

std::vector<TileKey> TileStore::released(const fs::path& strip_folder) {
  std::vector<TileKey> out;
  const core::Value note = strip_note(strip_folder);
  for (const core::Value& tile : note.find("tiles")->items())
    if (const TileKey key = key_of(tile); !fs::exists(strip_folder / points_file(key))) out.push_back(key);
  return out;
}

void TileStore::release(TileKey key) const {
  const auto at = segments_.find(key);
  if (at == segments_.end()) return;
  std::error_code stays;
  for (const Segment& s : at->second) fs::remove(s.file, stays);
}

void TileStore::open(const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    const core::Value index = strip_note(strips_ / name);
    // Strips of several files need not have the same columns.
    columns_ = columns_ | ChunkHead{0, static_cast<std::uint32_t>(index.find("columns")->as_int())}.set();
    source_width_ = std::max(source_width_, static_cast<size_t>(index.find("source_width")->as_int()));
    for (const core::Value& one : index.find("tiles")->items()) {
      const TileKey key = key_of(one);
      if (one.items().size() != 7) throw core::Error("its index of tiles is damaged", (strips_ / name).string(), "remove the work folder");
      const auto n = static_cast<std::uint64_t>(one.items()[2].as_int());
      const auto edge = [&](size_t k) { return one.items().at(k).as_number(); };
      const stages::Box extent{edge(3), edge(4), edge(5), edge(6)};
      const auto [of_tile, is_new] = extents_.try_emplace(key, extent);
      if (!is_new) of_tile->second = joined(of_tile->second, extent);
      segments_[key].push_back({strips_ / name / points_file(key), n});
      tiles_[key] += n;
      points_ += n;
    }
  }
}

void TileStore::assume(TileKey key, std::uint64_t points, ColumnSet columns) {
  tiles_[key] += points;
  extents_[key] = TileBox(key, key).metres(side_);
  points_ += points;
  columns_ = columns_ | columns;
}

std::set<TileKey> TileStore::fringe(double halo) const {
  const int reach = static_cast<int>(std::ceil(halo / side_));
  std::set<TileKey> out;
  for (const auto& [key, n] : tiles_)
    for (int iy = key.iy - reach; iy <= key.iy + reach; ++iy)
      for (int ix = key.ix - reach; ix <= key.ix + reach; ++ix)
        if (!tiles_.contains({ix, iy})) out.insert({ix, iy});
  return out;
}

void TileStore::add_overlay(fs::path folder, ColumnSet columns) {
  overlays_.emplace_back(std::move(folder), columns);
  columns_ = columns_ | columns;
}

PieceFile TileStore::write_overlay(const fs::path& folder, TileKey key, const Block& block, size_t first, size_t count,
                                   ColumnSet columns) const {
  const std::string name = file_label(key) + ".cols";
  io::OutputFile out(folder / name);
  Checksum sum;
  StoreFile file(out.temporary(), StoreFile::Mode::append, &sum);
  write_chunks(file, block, first, count, columns);
  file.close();
  out.commit();
  return {name, file.written(), sum.text()};
}

TileStore::Overlays TileStore::overlays_of(TileKey key, ColumnSet columns) const {
  Overlays out;
  for (auto o = overlays_.rbegin(); o != overlays_.rend(); ++o) {
    ColumnSet mine;
    for (int c = 0; c < core::column_count; ++c) {
      const auto column = static_cast<Column>(c);
      if (columns.has(column) && o->second.has(column) && !out.columns.has(column)) mine.add(column);
    }
    if (mine.empty()) continue;
    out.columns = out.columns | mine;
    out.files.emplace_back(o->first / (file_label(key) + ".cols"), mine);
  }
  return out;
}

void TileStore::expect_whole(TileKey key, size_t rows) const {
  if (rows != tiles_.at(key)) throw damaged_work(strips_ / file_label(key));
}

std::vector<std::uint32_t> TileStore::counts_of(TileKey key, int n) const {
  std::vector<std::uint32_t> counts(static_cast<size_t>(n) * static_cast<size_t>(n), 0);
  if (const auto at = tiles_.find(key); at != tiles_.end() && !segments_.contains(key)) {
    counts.assign(counts.size(), static_cast<std::uint32_t>(at->second / counts.size()));
    return counts;
  }
  each_rows(key, {}, [&](Block& b) {
    for (size_t i = 0; i < b.size(); ++i) {
      const auto [across, up] = TilePart::square_of(key, n, origin_.x() + b.x[i], origin_.y() + b.y[i], side_);
      ++counts[static_cast<size_t>(up) * static_cast<size_t>(n) + static_cast<size_t>(across)];
    }
  });
  return counts;
}

namespace {

/// Tiles from a number to those from `low` to `high`.
int apart(int i, int low, int high) { return std::max({low - i, i - high, 0}); }

}  // namespace

TileStore::Load TileStore::load_with_halo(const std::vector<TileKey>& keys, double halo) const {
  Load load;
  for (const TileKey k : keys) {
    const auto at = tiles_.find(k);
    if (at != tiles_.end()) load.points += at->second;
  }
  if (halo <= 0) return load;
  constexpr double unevenness = 1.3;  // points of a neighbour may lie denser along the common edge
  const TileBox tiles(keys);
  const int reach = static_cast<int>(std::ceil(halo / side_));
  for (int iy = tiles.low.iy - reach; iy <= tiles.high.iy + reach; ++iy)
    for (int ix = tiles.low.ix - reach; ix <= tiles.high.ix + reach; ++ix) {
      const auto at = tiles_.find({ix, iy});
      if (tiles.holds({ix, iy}) || at == tiles_.end()) continue;
      // Share of the neighbour that the halo covers.
      const auto share = [&](int d) { return d == 0 ? 1.0 : std::clamp((halo - (d - 1) * side_) / side_, 0.0, 1.0); };
      const auto points = static_cast<std::uint64_t>(
          static_cast<double>(at->second) *
          std::min(1.0, unevenness * share(apart(ix, tiles.low.ix, tiles.high.ix)) * share(apart(iy, tiles.low.iy, tiles.high.iy))));
      load.points += points;
      load.neighbour = std::max(load.neighbour, points);
    }
  return load;
}

std::uint64_t TileStore::left_around(const std::vector<TileKey>& keys, double near, double halo, double per_area) const {
  const TileBox tiles(keys);
  const stages::Box inner = tiles.metres(side_).grown(near), outer = tiles.metres(side_).grown(halo);
  double left = 0.0;
  const auto add = [&](TileKey key, const stages::Box& extent) {
    if (tiles.holds(key)) return;
    const stages::Box there = extent.grown(1.0);  // cells at its rim hold points, too
    left += std::min(static_cast<double>(tiles_.at(key)), per_area * (common_area(there, outer) - common_area(there, inner)));
  };
  const auto tile = [&](double edge) { return static_cast<int>(std::floor(edge / side_)); };
  const int x0 = tile(outer.x0 - 1.0), x1 = tile(outer.x1 + 1.0), y0 = tile(outer.y0 - 1.0), y1 = tile(outer.y1 + 1.0);
  for (int iy = y0; iy <= y1; ++iy)
    for (int ix = x0; ix <= x1; ++ix)
      if (const auto found = extents_.find({ix, iy}); found != extents_.end()) add(found->first, found->second);
  return static_cast<std::uint64_t>(left);
}

stages::Box TileStore::extent_in(const stages::Box& box) const {
  const auto tile = [&](double edge) { return static_cast<int>(std::floor(edge / side_)); };
  std::optional<stages::Box> all;
  for (int iy = tile(box.y0); iy <= tile(box.y1); ++iy)
    for (int ix = tile(box.x0); ix <= tile(box.x1); ++ix)
      if (const auto at = extents_.find({ix, iy}); at != extents_.end()) all = all ? joined(*all, at->second) : at->second;
  if (!all) return {box.x0, box.y0, box.x0, box.y0};
  const auto inside = [](double v, double low, double high) { return std::clamp(v, low, high); };
  return {inside(all->x0, box.x0, box.x1), inside(all->y0, box.y0, box.y1), inside(all->x1, box.x0, box.x1),
          inside(all->y1, box.y0, box.y1)};
}

}  // namespace swath::pipeline
