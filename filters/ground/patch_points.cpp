// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/ground/patch_points.h"

#include <algorithm>

#include "core/area.h"

namespace swath::filters {

PatchPoints::PatchPoints(const core::Block& b, const Patch& patch, const Eigen::Vector3d& corner, const PatchThinning& how) {
  const core::Box whole = core::Box{patch.x0, patch.y0, patch.x0 + patch.side, patch.y0 + patch.side}.grown(how.whole);
  const auto is_whole = [&](std::uint32_t p) { return whole.holds(b.origin.x() + b.x[p], b.origin.y() + b.y[p]); };
  std::vector<std::uint32_t> lowest(static_cast<size_t>(how.across) * static_cast<size_t>(how.across), none);
  const auto lowest_at = [&](std::uint32_t p) -> std::uint32_t& {
    const auto index = [&](double v) { return static_cast<size_t>(std::clamp(static_cast<int>(v / how.cell), 0, how.across - 1)); };
    return lowest[index(b.y[p] - corner.y()) * static_cast<size_t>(how.across) + index(b.x[p] - corner.x())];
  };
  for (const std::uint32_t p : patch.rows) {
    if (is_whole(p)) continue;
    std::uint32_t& least = lowest_at(p);
    if (least == none || b.z[p] < b.z[least]) least = p;
  }
  std::uint32_t last = none;
  for (const std::uint32_t p : patch.rows) {
    const bool taken = is_whole(p) || lowest_at(p) == p;
    if (taken && (last == none || b.x[last] != b.x[p] || b.y[last] != b.y[p])) {
      points.push_back(Eigen::Vector3d(b.x[p], b.y[p], b.z[p]) - corner);
      last = p;
    }
    point_of_row.push_back(taken ? static_cast<std::uint32_t>(points.size() - 1) : none);
  }
}

}  // namespace swath::filters
