// SPDX-License-Identifier: GPL-3.0-or-later
// What every ground filter does at its end: the class of each own point from the verdict on it.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "core/block.h"
#include "core/config/result.h"
#include "filters/bins.h"
#include "filters/ground/ground_columns.h"

namespace swath::filters {

/// The verdict of a ground filter on one point.
enum class Verdict : std::uint8_t { object, ground, no_surface };

/// What one call of a ground filter did, counted over the own points.
struct GroundCounts {
  core::Changed ground, object;
  core::Kept untouched;
  std::uint64_t early = 0;       ///< among `object`: a later return of the same pulse lies below
  std::uint64_t no_surface = 0;  ///< among `object`: no ground within reach to compare with
};

template <class V>
void describe(const GroundCounts& r, V& v) {
  v.result("ground", r.ground, "Returns classified as ground.");
  v.result("not ground", r.object, "Returns classified as unassigned.");
  v.result("early returns, not ground", r.early, core::if_any(), "Of those not ground: a later return of the pulse lies below.");
  v.result("withheld or noise, not looked at", r.untouched, core::if_any(), "Returns that keep their class.");
  v.result("no ground within reach", r.no_surface, core::if_any(), "Of those not ground: without ground nearby to compare with.");
}

/// True for the points that ground filters look at: usable last and only returns. An earlier return has one of the same pulse behind it:
/// the beam went on, so the ground is not there.
inline bool may_be_ground(const core::Block& b, size_t p) { return core::is_usable(b, p) && core::is_last_return(b, p); }

/// The same of n points from `first` on: 1 or 0 each.
void may_be_ground(const core::Block& b, size_t first, size_t n, std::uint8_t* may);

/// Calls take(point, column, row, may_be_ground) for all points of the block, with their cells in the lattice.
template <class Take>
void for_each_cell(const core::Block& b, const core::Lattice& l, const Take& take) {
  constexpr size_t together = 1024;
  std::array<std::int32_t, together> column{}, row{};
  std::array<std::uint8_t, together> may{};
  for (size_t first = 0; first < b.size(); first += together) {
    const size_t n = std::min(together, b.size() - first);
    cells_of(l, b, first, n, column.data(), row.data());
    may_be_ground(b, first, n, may.data());
    for (size_t k = 0; k < n; ++k) take(first + k, column[k], row[k], may[k] != 0);
  }
}

/// Sets class ground or unassigned on the usable points among the first `own`; verdicts on points that may not be ground do not count.
/// `verdicts` has one entry per point of the block.
GroundCounts set_ground_classes(core::Block& block, size_t own, const std::vector<Verdict>& verdicts);

}  // namespace swath::filters
