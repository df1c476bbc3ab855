// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/ground/ground_labels.h"

#include <algorithm>

namespace swath::filters {

void may_be_ground(const core::Block& b, size_t first, size_t n, std::uint8_t* may) {
  std::fill_n(may, n, std::uint8_t{1});
  if (!b.flags.empty())
    for (size_t k = 0; k < n; ++k) may[k] &= (b.flags[first + k] & core::flag::withheld) == 0;
  if (!b.classification.empty())
    for (size_t k = 0; k < n; ++k)
      may[k] &= b.classification[first + k] != core::point_class::low_noise && b.classification[first + k] != core::point_class::high_noise;
  if (!b.return_number.empty() && !b.return_count.empty())
    for (size_t k = 0; k < n; ++k) may[k] &= b.return_number[first + k] >= b.return_count[first + k];
}

GroundCounts set_ground_classes(core::Block& b, size_t own, const std::vector<Verdict>& verdicts) {
  GroundCounts n;
  if (b.classification.empty()) core::add_columns(b, {core::Column::classification});
  for (size_t p = 0; p < own; ++p) {
    if (!core::is_usable(b, p)) {
      ++n.untouched;
      continue;
    }
    const bool early = !core::is_last_return(b, p);
    const bool ground = !early && verdicts[p] == Verdict::ground;
    b.classification[p] = ground ? core::point_class::ground : core::point_class::unassigned;
    ++(ground ? n.ground : n.object);
    if (early)
      ++n.early;
    else if (verdicts[p] == Verdict::no_surface)
      ++n.no_surface;
  }
  return n;
}

}  // namespace swath::filters
