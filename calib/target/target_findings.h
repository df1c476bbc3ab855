// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "calib/target/flat_target_result.h"

namespace swath::calib {

/// What a finished analysis `t` does not show, or what looks wrong, in words. `present`: the calibration before; `steady`: nothing moved in
/// the last round.
std::vector<std::string> target_findings(const FlatTarget& t, const AngleReadings& readings, const TargetMeasures& measures,
                                         const core::Calibration& present, bool steady);

}  // namespace swath::calib
