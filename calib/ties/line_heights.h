// SPDX-License-Identifier: GPL-3.0-or-later
// Heights of single flight lines on one lattice, and how the lines differ where they overlap.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "core/block.h"
#include "core/config/option.h"
#include "core/grid.h"

namespace swath::calib {

struct LineHeightOptions {
  std::optional<core::Metres> cell;
  core::Metres roughness{0.10};
  int least = 5;
};

template <class V>
void describe(LineHeightOptions& o, V& v) {
  v.option("cell", o.cell, core::within(0.2, 100),
           "Side of the cells in which two lines' heights are compared; by default for 12 returns of a line.");
  v.option("roughness", o.roughness, core::above(0),
           "Compare a cell where each line's single returns fit a plane of their own within this rms.");
  v.option("least", o.least, core::within(4, 1000), "... and are at least this many.");
}

/// Fits a plane to the single returns of each line in each cell. Where a line comes in several pieces with others between them, a cell that
/// two pieces share keeps that of more returns. Memory: 80 bytes per cell of the line at work, in squares of 64 cells, and about 100 per
/// smooth cell of every line.
class LineHeights {
 public:
  /// `automatic`: side of the cells where the options state none, m.
  LineHeights(const LineHeightOptions& options, double automatic)
      : options_(options), cell_(options.cell ? options.cell->value : automatic) {}

  /// Adds the single and last returns of a block of one line; coordinates in map metres.
  void add(int line, const core::Block& block);

  /// A smooth cell: the plane's height at the cell's centre, and its slope (rise / run).
  struct Cell {
    double height = 0;
    float slope = 0;
    std::uint32_t count = 0;
  };
  using Key = std::pair<std::int64_t, std::int64_t>;  ///< cell number along x and y
  /// By line id, then cell. Ends the line at work.
  const std::map<int, std::map<Key, Cell>>& lines();
  double cell() const { return cell_; }

 private:
  struct Moments {
    double n = 0, x = 0, y = 0, z = 0, xx = 0, xy = 0, yy = 0, xz = 0, yz = 0, zz = 0;
  };
  void close();
  static constexpr int page_side = 64;

  LineHeightOptions options_;
  double cell_;
  int line_ = 0;
  double origin_height_ = 0;
  std::map<Key, std::vector<Moments>> pages_;  // of the line at work; page (i, j) holds page_side^2 cells
  Key last_page_{};
  std::vector<Moments>* last_ = nullptr;
  std::map<int, std::map<Key, Cell>> lines_;
};

/// Statistics of the differences of two lines, a minus b, over the cells that both have smooth.
struct LineDifferenceStatistics {
  int line_a = 0, line_b = 0;
  std::uint64_t cells = 0;
  double mean = 0.0, rms = 0.0, median_abs = 0.0;  ///< m, of the distances along the surface's normal: difference in height * cos(slope)
};

struct LineDifferenceMap {
  LineDifferenceStatistics statistics;
  core::Grid grid;  ///< difference in height, m; NaN where the two lines do not both have a smooth cell
};

/// One for each pair of lines with at least `least` cells in common, by ids.
std::vector<LineDifferenceMap> line_differences(LineHeights& heights, std::uint64_t least = 50);

/// Over all pairs: root of the mean square of the cells' differences, each pair with the weight of its cells. 0 without pairs.
double overall_rms(const std::vector<LineDifferenceMap>& maps);

}  // namespace swath::calib
