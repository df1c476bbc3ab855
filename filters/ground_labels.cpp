// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/ground_labels.h"

namespace swath::filters {

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
