// SPDX-License-Identifier: GPL-3.0-or-later
// A bounded sample of the returns for work by cells: cells as wide as the returns are apart, at most a few returns of each.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "core/block.h"
#include "core/grid.h"

namespace swath::filters {

/// Sides (m) of sample cells; each divides the side of a district.
constexpr std::array<double, 4> sample_sides{1.0, 1.5, 2.0, 3.0};
constexpr double district_side = 12.0;      ///< m: squares that have one side of cells each
constexpr double returns_of_cell = 4.0;     ///< usual number that a cell should hold
constexpr std::size_t samples_of_cell = 4;  ///< at most
constexpr int sample_border = 4;            ///< cells around those that planes are looked for in

/// Which side of cells each district has: the narrowest whose cells usually hold `returns_of_cell` returns, else the widest.
struct Districts {
  core::Lattice lattice;
  std::vector<std::uint8_t> side;  ///< index into sample_sides

  /// Share of the cells of 1 m that usually hold a return, where cells have this side.
  static double occupied(std::uint8_t side) { return 1.0 - std::exp(-returns_of_cell / (sample_sides[side] * sample_sides[side])); }

  /// Cells of 1 m from one that holds a return to the next on the same surface, where cells have this side.
  static int link(std::uint8_t side) { return std::max(2, static_cast<int>(std::ceil(4.0 / 3.0 * sample_sides[side]))); }

  /// At map coordinates within the lattice.
  std::uint8_t side_at(double x, double y) const {
    return side[lattice.at(static_cast<int>(core::cell_index(x, lattice.cell) - lattice.i0),
                           static_cast<int>(core::cell_index(y, lattice.cell) - lattice.j0))];
  }

  /// Metres of points around a place that its side depends on.
  static double halo() { return 2.0 * district_side; }
};

/// Usual is the median over the cells of 3 m of the district and those around it that hold any usable return.
Districts districts(const core::Block& b);

/// Usable returns by the cells of a lattice, at most samples_of_cell in each: those of the least hash of their coordinates, so that the
/// sample depends neither on the order of the returns nor on other cells.
class Samples {
 public:
  Samples(const core::Block& b, const core::Lattice& l);

  struct Sample {
    float x, y;  ///< m from the cell's centre
    float z;     ///< as in the block, m
    std::uint32_t row;
  };

  const core::Lattice& lattice() const { return lattice_; }
  /// In an order that depends on their coordinates only.
  std::span<const Sample> in(int i, int j) const {
    const std::size_t c = lattice_.at(i, j);
    return {samples_.data() + c * samples_of_cell, count_[c]};
  }

 private:
  core::Lattice lattice_;
  std::vector<std::uint8_t> count_;
  std::vector<Sample> samples_;
};

}  // namespace swath::filters
