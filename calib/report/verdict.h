// SPDX-License-Identifier: GPL-3.0-or-later
// A calibration in the words of a surveyor.
#pragma once

#include <string>

#include "calib/adjust/adjustment.h"
#include "calib/adjust/parameter_words.h"
#include "calib/adjust/strips.h"
#include "report/page.h"

namespace swath::calib {

constexpr int estimated_count = calib::latency + 1;
/// All parameters that an adjustment can estimate, in order.
inline calib::Parameter parameter_at(int k) { return static_cast<calib::Parameter>(k); }

/// Is it estimated, and refused by no finding? Only then is its value delivered.
bool is_delivered(const calib::Adjustment& adjustment, calib::Parameter parameter);
/// Does a finding refuse it?
bool is_refused(const calib::Adjustment& adjustment, calib::Parameter parameter);

struct CalibrationVerdict {
  bool calibrated = false;  ///< every estimated angle of the boresight is delivered, and something is
  report::Tone tone = report::Tone::bad;
  std::string text;  ///< "Calibrated: boresight roll, pitch and heading are known to 1.2, 1.9 and 3.4 arcsec (one sigma), ..."
};
/// "Not calibrated: WHAT. CURE" where a finding refuses an angle of the boresight or nothing is delivered. Otherwise the delivered
/// parameters with their sigmas, then what is coarse, what is not determined, and how many surveyed points disagree.
CalibrationVerdict verdict_of(const calib::Adjustment& adjustment);

/// Of a strip adjustment: "Lines meet within 0.8 cm on planes (8.3 cm before) ...", rms over all pairs of lines; `calibrated` is always
/// false.
CalibrationVerdict verdict_of_strips(const calib::Adjustment& adjustment, const calib::PlaneDifferences& differences);

/// "a", "a and b", "a, b and c".
std::string joined(const std::vector<std::string>& items);

}  // namespace swath::calib
