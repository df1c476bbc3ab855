// SPDX-License-Identifier: GPL-3.0-or-later
// Flight lines whose records contradict the others': a shift of fixes, a wrong lever arm, late times show in one line and in no sum.
#pragma once

#include <vector>

#include "calib/adjust/adjustment.h"
#include "calib/ties/tie_set.h"

namespace swath::calib {

/// A sentence for each line (1) whose mean correction is beyond what the sigmas before and after allow, by its worst component, and (2) of
/// whose groups on planes many have no weight, many more than of the other lines. `corrections` of the smoother's trajectory with both
/// sigmas; `groups` by their line's place in `lines`.
std::vector<Finding> doubtful_lines(const std::vector<TieLine>& lines, const std::vector<LineCorrection>& corrections,
                                    const std::vector<GroupResidual>& groups);

}  // namespace swath::calib
