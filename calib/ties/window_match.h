// SPDX-License-Identifier: GPL-3.0-or-later
// How well two rasters of heights fit one another under every displacement of a range.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calib/ties/height_grid.h"

namespace swath::calib {

/// What stands in a raster, about the plane through its heights, m.
struct Relief {
  double rms = 0.0;     ///< of the heights
  double shared = 0.0;  ///< part of it that cells two apart have in common: buildings, banks and knolls, not noise and single crowns
};
/// Nothing where fewer than 40 % of the cells have a height.
std::optional<Relief> relief_of(const Raster& r);

/// One displacement of `b` against `a`, in whole cells.
struct ShiftFit {
  int cells = 0;      ///< that both have
  double cost = 0.0;  ///< mean square of the height differences about their own plane, each bounded by 1.5^2 m^2, m^2
  double rise = 0.0;  ///< of `b` over `a` at the middle of `a`, m
};
/// b(x + margin + shift) - a(x) = rise + tilt x. `b` is wider than `a` by the margin on each side. Nothing where fewer than 30 % of
/// the cells of `a` meet a height.
/// `refits`: times that the plane is fitted again with bounded differences.
std::optional<ShiftFit> fit_shift(const Raster& a, const Raster& b, int margin_x, int margin_y, int shift_x, int shift_y, int refits = 0);

/// Costs of all shifts within the margins. `wanted` (may be empty: all): which of them to try, row by row from the south-west.
struct ShiftCosts {
  int margin_x = 0, margin_y = 0;
  std::vector<float> share;  ///< cost / median cost of all shifts; 1 where there is none
  double typical = 0.0;      ///< that median, m^2

  size_t at(int x, int y) const { return static_cast<size_t>((y + margin_y) * (2 * margin_x + 1) + x + margin_x); }
  /// Between shifts, bilinear; 1 beyond the margins.
  double operator()(double x, double y) const;
};
ShiftCosts shift_costs(const Raster& a, const Raster& b, int margin_x, int margin_y, const std::vector<char>& wanted);

/// A displacement to a fraction of a cell.
struct SubcellShift {
  Eigen::Vector2d shift;       ///< cells
  Eigen::Matrix2d covariance;  ///< cells^2
  double rise = 0.0;           ///< m
  double rise_variance = 0.0;  ///< m^2
  double share = 1.0;          ///< cost there / typical cost
};
/// The bottom of the quadric through the nine costs about the lowest shift within `reach` cells of `near`. Nothing where the lowest lies on
/// the rim of what was looked at, or where the costs have no bottom.
std::optional<SubcellShift> subcell_shift(const Raster& a, const Raster& b, const ShiftCosts& costs, const Eigen::Vector2d& near,
                                          int reach);

}  // namespace swath::calib
