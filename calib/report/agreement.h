// SPDX-License-Identifier: GPL-3.0-or-later
// The flat target beside the adjustment.
#pragma once

#include "calib/report/report_data.h"
#include "calib/report/verdict.h"

namespace swath::calib {

/// How two ways to one parameter agree. Both rest on the same flight, so their joint sigma is rather too large than too small.
struct Agreement {
  double difference = 0.0, joint_sigma = 0.0;  ///< reading minus adjusted
  bool known = false;                          ///< the parameter was estimated and delivered
  bool agrees = false;                         ///< |difference| <= agreement_limit joint_sigma
};
constexpr double agreement_limit = 2.0;
Agreement agreement_of(const calib::Adjustment& adjustment, const TargetReading& reading);

/// Of a whole report, a strip adjustment's too: a flat target that disagrees with the adjustment is said, and the banner is not green.
CalibrationVerdict verdict_of(const CalibrationReport& report);

}  // namespace swath::calib
