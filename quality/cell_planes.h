// SPDX-License-Identifier: GPL-3.0-or-later
// A plane by least squares through the single returns of one line in one cell.
#pragma once

#include <optional>

#include "core/block.h"

namespace swath::quality {

/// Sums over returns; x, y, z in m from any one place.
struct PlaneSums {
  double n = 0, x = 0, y = 0, z = 0, xx = 0, xy = 0, yy = 0, xz = 0, yz = 0, zz = 0;
  void add(double px, double py, double pz);
  void add(const PlaneSums& o);
};

struct CellPlane {
  double height, rms, east, north;  ///< height at the cell's centre, rms of the returns about it, m; east, north: rise / run
  double slope_squared() const { return east * east + north * north; }
};

/// Nothing where the returns do not span the cell, for the height at its centre would be a guess, and where the plane is steeper than 1.5.
/// `cx`, `cy`: the cell's centre; `cell`: its side, m.
std::optional<CellPlane> plane_of(const PlaneSums& sums, double cx, double cy, double cell);

/// Root of the lower quartile of chi square over its degrees of freedom (Wilson and Hilferty 1931): a cell's rms divided by it has a lower
/// quartile over cells on planes that is the standard deviation of a return, and rough cells, up to half of them, hardly raise it.
double quartile_of(double freedom);

/// Is the point a usable single return?
inline bool is_single(const core::Block& b, std::size_t p) {
  return core::is_usable(b, p) && core::is_last_return(b, p) && (b.return_number.empty() || b.return_number[p] <= 1);
}

}  // namespace swath::quality
