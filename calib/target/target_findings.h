// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "calib/target/flat_target_result.h"

namespace swath::calib {

struct TargetFindings {
  std::vector<std::string> findings;  ///< what is not determined or looks wrong, each with what to do
  std::vector<std::string> notes;     ///< what is right, or was allowed for
};

/// What a finished analysis `t` shows, in words. `present`: the calibration before; `steady`: nothing moved in the last round.
TargetFindings target_findings(const FlatTarget& t, const AngleReadings& readings, const TargetMeasures& measures,
                               const core::Calibration& present, bool steady);

}  // namespace swath::calib
