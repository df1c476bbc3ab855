// SPDX-License-Identifier: GPL-3.0-or-later
// Single returns by cell and line, and a plane by least squares through those of one line in one cell.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

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

constexpr std::uint32_t no_cell = std::numeric_limits<std::uint32_t>::max();

struct CellReturn {
  double x, y, z;  ///< m, from a place that all returns of a cell share
  float sigma;     ///< m, of the height
  std::uint16_t line;
  /// By line and place: sums over returns in this order do not depend on that of the points.
  bool operator<(const CellReturn& o) const {
    if (line != o.line) return line < o.line;
    if (x != o.x) return x < o.x;
    if (y != o.y) return y < o.y;
    return z != o.z ? z < o.z : sigma < o.sigma;
  }
};

/// Returns by cell (counting sort), within a cell in their order. Memory: 36 bytes per point, 4 per cell.
class ReturnsByCell {
 public:
  /// `cell_of` gives the cell of a point, below `cells`, or no_cell; `return_of` the return of a point in its cell.
  template <class CellOf, class ReturnOf>
  ReturnsByCell(std::size_t points, std::size_t cells, CellOf&& cell_of, ReturnOf&& return_of) : start_(cells + 1, 0) {
    std::vector<std::uint32_t> cell(points);
    for (std::size_t p = 0; p < points; ++p)
      if (cell[p] = cell_of(p); cell[p] != no_cell) ++start_[cell[p]];
    std::uint32_t sum = 0;
    for (std::uint32_t& s : start_) s = sum += s;  // the end of each cell, which moves to its start as it is filled
    returns_.resize(sum);
    for (std::size_t p = points; p-- > 0;)
      if (cell[p] != no_cell) returns_[--start_[cell[p]]] = return_of(p);
    for (std::size_t c = 0; c < cells; ++c) std::sort(returns_.begin() + start_[c], returns_.begin() + start_[c + 1]);
  }

  std::span<const CellReturn> in(std::size_t cell) const { return {returns_.data() + start_[cell], returns_.data() + start_[cell + 1]}; }

 private:
  std::vector<std::uint32_t> start_;
  std::vector<CellReturn> returns_;
};

}  // namespace swath::quality
