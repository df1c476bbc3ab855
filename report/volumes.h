// SPDX-License-Identifier: GPL-3.0-or-later
// Cut and fill between two surfaces on a lattice.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/grid.h"

namespace swath::report {

/// A closed line without its repeated vertex, or with it. Of several, those inside an odd number of others are holes; neighbours and such
/// that overlap in part count together, once, but for cells on a border of one within the other: there shares add up, to 1 at most.
using Ring = std::vector<Eigen::Vector2d>;

/// Earth that is taken away (cut) and heaped up (fill) from `before` to `after`. Units are those of the grids: lengths cubed, squared.
struct Volumes {
  double cut = 0.0, fill = 0.0;
  double net = 0.0;                        ///< fill - cut
  double area = 0.0;                       ///< on which both surfaces are known, inside the polygon
  double cut_area = 0.0, fill_area = 0.0;  ///< where the ground fell, where it rose
  /// One sigma; NaN where a cell counted has no sigma.
  double sigma_cut = 0.0, sigma_fill = 0.0, sigma_net = 0.0;
  std::uint64_t cells = 0;     ///< counted, whole or in part
  std::uint64_t left_out = 0;  ///< cells of the polygon where a surface is void; without a polygon where one of the two is
  double area_left_out = 0.0;
};

/// Volumes summed over pieces that share no cell, so that surfaces of any size pass through in bands of rows.
class VolumeSum {
 public:
  /// As volumes().
  VolumeSum(double height_unit, double correlation, std::vector<Ring> polygon = {})
      : height_unit_(height_unit), correlation_(correlation), polygon_(std::move(polygon)) {}
  /// Both grids on one lattice, otherwise core::Error.
  void add(const core::Grid& before, const core::Grid& after);
  Volumes result() const;

 private:
  /// Of one of cut, fill and net: its value, and by model the sums of a_c s_c and of their squares.
  struct Sum {
    double value = 0.0;
    std::array<double, 2> linear{}, square{};
    void add(double volume, double area, double s0, double s1);
    double sigma(double correlation) const;
  };
  double height_unit_, correlation_;
  std::vector<Ring> polygon_;
  Volumes out_;
  Sum cut_, fill_, net_;
};

/// Both grids on one lattice; `after` may be empty of sigma, as a design is. `height_unit`: horizontal units per unit of height, 1 where
/// they are the same. `correlation`, 0 to 1, of the errors of any two cells of a model: 1 where trajectory and datum govern, 0 where
/// noise does; between the two models none is assumed. `polygon`: in the coordinates of the lattice; empty for all cells. A cell that the
/// polygon cuts counts with the share of its area inside. Throws core::Error where the lattices differ.
Volumes volumes(const core::Grid& before, const core::Grid& after, double height_unit, double correlation,
                const std::vector<Ring>& polygon = {});

/// Height and sigma of the grid at a place, bilinear between cell centres: NaN where one of the four cells around is void or outside;
/// sigma NaN where the grid has none.
struct GridSample {
  double height, sigma;
};
GridSample sample(const core::Grid& grid, double x, double y);

/// The grid's heights and sigmas at the cell centres of another lattice, bilinear: void where one of the four cells around is.
core::Grid resampled(const core::Grid& grid, const core::Lattice& lattice);

/// Share of each cell of the lattice, 0 to 1, inside the polygon (row-major as in core::Grid): exact for straight sides.
std::vector<double> shares_inside(const core::Lattice& lattice, const std::vector<Ring>& polygon);

}  // namespace swath::report
