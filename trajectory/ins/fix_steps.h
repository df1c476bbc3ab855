// SPDX-License-Identifier: GPL-3.0-or-later
// Steps of the fixes' error: from one fix on all are shifted by the same vector, as with another base station, a wrong ambiguity, another
// antenna. A single wrong fix is not a step.
#pragma once

#include <vector>

#include "trajectory/ins/ins_filter.h"

namespace swath::trajectory {

/// Adds the steps that the fixes show against the IMU, at most one in 10 s, to those of the problem; true where there were any. Where they
/// are more than one in a minute (and than two) all are dropped. `filter`: as at the first node.
bool add_fix_steps(Problem& problem, InsFilter filter);

}  // namespace swath::trajectory
