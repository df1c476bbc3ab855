// SPDX-License-Identifier: GPL-3.0-or-later
// The points of a survey on disk, by tile and by column. Strips are written once, each whole or not at all; tile stages add
// overlays of the columns they change. The order of a tile's points is strip by strip, in the order of the records,
// so that it depends neither on threads nor on a resumed run.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <set>
#include <vector>

#include "core/block.h"
#include "pipeline/tile_groups.h"
#include "pipeline/work/checksum.h"
#include "pipeline/work/piece_record.h"
#include "stages/stage.h"

namespace swath::pipeline {

using stages::TileKey;

/// Scatters one strip's blocks over tiles. commit() makes the strip part of the store; without it nothing stays.
class StripWriter {
 public:
  /// `buffer_bytes`: memory for points not yet on disk.
  StripWriter(std::filesystem::path folder, double tile_side, size_t buffer_bytes);
  ~StripWriter();
  StripWriter(const StripWriter&) = delete;
  StripWriter& operator=(const StripWriter&) = delete;

  void write(const core::Block& block);
  /// `note` is kept with the strip and comes back from TileStore::note().
  void commit(const std::string& note);

 private:
  void flush(TileKey key, core::Block& points);
  std::filesystem::path final_, part_;
  double tile_side_;
  size_t buffer_bytes_, buffered_ = 0;
  std::map<TileKey, core::Block> pending_;
  core::ColumnSet columns_;
  size_t source_width_ = 0;
  std::vector<std::uint8_t> fields_;  ///< of the rows of the column `source`, as the first block has them
  /// What went to the file of one tile.
  struct Written {
    std::uint64_t points = 0, bytes = 0;
    stages::Box extent;  ///< of the points, map metres
    Checksum checksum;
  };
  std::map<TileKey, Written> written_;
  bool committed_ = false;
};

/// Empties all columns but these.
void keep_columns(core::Block& block, core::ColumnSet kept);

class TileStore {
 public:
  /// `strips`: the folder that holds one folder per committed strip.
  TileStore(std::filesystem::path strips, double tile_side, const Eigen::Vector3d& origin);

  static bool is_committed(const std::filesystem::path& strip_folder);
  static std::string note(const std::filesystem::path& strip_folder);

  /// The tiles of a committed strip whose points are not there any more.
  static std::vector<TileKey> released(const std::filesystem::path& strip_folder);

  /// Reads the list of tiles after all strips are committed. `names`: the strips' folders, in order.
  void open(const std::vector<std::string>& names);

  const std::map<TileKey, std::uint64_t>& tiles() const { return tiles_; }
  std::uint64_t points() const { return points_; }
  /// The tiles without a point that have tiles with points within `halo` metres: a surface may reach into them.
  std::set<TileKey> fringe(double halo) const;
  core::ColumnSet columns() const { return columns_; }
  /// Bytes of the widest row of the column `source`; 0 where no strip has it.
  size_t source_width() const { return source_width_; }

  /// Without a file: so many points, evenly spread over the tile, for what work on it would take.
  void assume(TileKey key, std::uint64_t points, core::ColumnSet columns);
  /// Removes a tile's points: no stage reads them any more.
  void release(TileKey key) const;

  /// From now on these columns of a tile are read from overlays in `folder`.
  void add_overlay(std::filesystem::path folder, core::ColumnSet columns);
  /// Writes the overlay of one tile, `count` points of the block from `first` on, and gives its file, named relative to `folder`.
  PieceFile write_overlay(const std::filesystem::path& folder, TileKey key, const core::Block& block, size_t first, size_t count,
                          core::ColumnSet columns) const;

  /// The columns of one tile's points (x, y, z always).
  core::Block read(TileKey key, core::ColumnSet columns) const;
  /// The points of tiles, one tile after the other, then those of their neighbours within `halo` metres of the box around them, in order
  /// of tiles; `own` receives the number of the former. `keys`: all with points of a box of tiles, or one. `thin`: takes out of some of
  /// one neighbour's points those that are not needed, more than once while they are read. `rows`: there is room for so many points from
  /// the start.
  core::Block read_with_halo(const std::vector<TileKey>& keys, double halo, core::ColumnSet columns, size_t& own,
                             const std::function<void(core::Block&)>& thin = {}, std::uint64_t rows = 0) const;
  /// The points of a part of a tile, then all others within `halo` metres of it. `rows`: gets the numbers of the former within the tile;
  /// `expected`: there is room for so many points from the start.
  core::Block read_part(const TilePart& part, double halo, core::ColumnSet columns, std::vector<std::uint32_t>& rows,
                        const std::function<void(core::Block&)>& thin = {}, std::uint64_t expected = 0) const;
  /// The columns of one tile's points from the first to the last, at most rows_at_once of them at a time.
  void each_rows(TileKey key, core::ColumnSet columns, const std::function<void(core::Block&)>& f) const;
  static constexpr size_t rows_at_once = 1u << 17;
  static constexpr size_t thinned_at_once = 1u << 18;  ///< points that wait for thin(), beside those that it has left
  /// Counts a tile's points in n x n squares of it, row by row from the south-west.
  std::vector<std::uint32_t> counts_of(TileKey key, int n) const;
  /// What read_with_halo loads, estimated to the safe side: the points it gives, and those of them that come from one neighbour at most.
  struct Load {
    std::uint64_t points = 0, neighbour = 0;
  };
  Load load_with_halo(const std::vector<TileKey>& keys, double halo) const;
  /// Of the points around the tiles, farther off than `near` and within `halo`, at most so many: `per_area` of each square metre that
  /// their tiles' points extend over.
  std::uint64_t left_around(const std::vector<TileKey>& keys, double near, double halo, double per_area) const;
  /// Around the points of those tiles that the box touches, as far as it goes; without area where there are none.
  stages::Box extent_in(const stages::Box& box) const;

 private:
  /// The files that overlay a tile's columns, and what each gives.
  struct Overlays {
    std::vector<std::pair<std::filesystem::path, core::ColumnSet>> files;
    core::ColumnSet columns;
  };
  Overlays overlays_of(TileKey key, core::ColumnSet columns) const;
  void expect_whole(TileKey key, size_t rows) const;
  /// Appends what read() gives; there is room for so many points in all.
  void append_tile(core::Block& out, TileKey key, core::ColumnSet columns, std::uint64_t room) const;
  /// The points at x, y (map metres) that lie in the box and are chosen.
  struct Wanted {
    stages::Box box;
    std::function<bool(double, double)> chosen{};  ///< all, without it
    bool operator()(double x, double y) const { return box.holds(x, y) && (!chosen || chosen(x, y)); }
  };
  /// Appends the wanted ones of a tile's points; of chunks without one only places are read. `rows`: gets their numbers within the tile.
  /// `grown`: gets the block after each chunk of which points were wanted, and may take points out.
  void append_where(core::Block& out, TileKey key, core::ColumnSet columns, const Wanted& wanted,
                    std::vector<std::uint32_t>* rows = nullptr, const std::function<void(core::Block&)>& grown = {}) const;
  /// Appends the points of a box: of `tiles` those that are not `own`, none without it.
  void append_around(core::Block& out, const TileBox& tiles, const stages::Box& box, core::ColumnSet columns,
                     const std::function<void(core::Block&)>& thin, const std::function<bool(double, double)>& own) const;

  std::filesystem::path strips_;
  double side_;
  Eigen::Vector3d origin_;
  struct Segment {
    std::filesystem::path file;
    std::uint64_t points;
  };
  std::map<TileKey, std::vector<Segment>> segments_;
  std::map<TileKey, std::uint64_t> tiles_;
  std::map<TileKey, stages::Box> extents_;  ///< of the tiles' points
  std::vector<std::pair<std::filesystem::path, core::ColumnSet>> overlays_;
  std::uint64_t points_ = 0;
  size_t source_width_ = 0;
  core::ColumnSet columns_;
};

/// "12_-3": name of a tile within the store.
std::string file_label(TileKey k);

}  // namespace swath::pipeline
