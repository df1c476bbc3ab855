// SPDX-License-Identifier: GPL-3.0-or-later
// Cells of a survey: which hold returns, and which of them belong together.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

namespace swath::terrain {

/// A cell of the survey's lattice, by its indices.
struct CellPlace {
  std::int64_t i = 0, j = 0;
  auto operator<=>(const CellPlace&) const = default;
};

/// Cells of one row from `first` to `last`.
struct CellRun {
  std::int64_t j = 0, first = 0, last = 0;
};

/// The cells, of any order and number each, as runs.
std::vector<CellRun> runs_of(std::vector<CellPlace> cells);

/// A set of cells.
class CellSet {
 public:
  /// Runs may touch and overlap.
  explicit CellSet(const std::vector<CellRun>& runs);
  bool holds(std::int64_t i, std::int64_t j) const;
  /// Groups of cells that touch, also at corners, are numbered from 0 by their least cell (row before column); `groups` of them.
  std::uint32_t group(std::int64_t i, std::int64_t j) const;  ///< of a cell that is in the set
  std::size_t groups() const { return groups_; }

 private:
  struct Piece {
    std::int64_t first, last;
    std::uint32_t group;
  };
  const Piece* find(std::int64_t i, std::int64_t j) const;
  void find_groups();
  std::map<std::int64_t, std::vector<Piece>> rows_;  ///< of a row, ascending and apart
  std::size_t groups_ = 0;
};

}  // namespace swath::terrain
