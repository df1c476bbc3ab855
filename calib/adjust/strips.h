// SPDX-License-Identifier: GPL-3.0-or-later
// Strip adjustment: the lines of a survey are brought onto one another by corrections of the trajectory, the calibration held.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "calib/adjust/adjust.h"
#include "calib/adjust/calibrate.h"
#include "calib/ties/tie_planes.h"
#include "core/config/result.h"

namespace swath::calib {

struct StripOptions {
  StripOptions() {
    planes.mismatch.value = 0.5;
    adjust.estimate = {false, false, false, false, false, false, false, false, false, false, false};
    adjust.corrections.spacing.value = 3.0;
  }
  int rounds = 4;
  core::Seconds least_spacing{0.25};
  TiePlaneOptions planes;
  AdjustOptions adjust;  ///< no calibration value is estimated
};

template <class V>
void describe(StripOptions& o, V& v) {
  v.option("rounds", o.rounds, core::within(1, 20),
           "Most times that planes are sought and adjusted; it ends before where the corrections stay the same.");
  v.option("least_spacing", o.least_spacing, core::above(0),
           "Minimum to which corrections.spacing is halved where the trajectory's errors vary faster.");
  v.table("planes", o.planes, "The search for planes; `mismatch` is that of the first round.");
  v.table("corrections", o.adjust.corrections, "Corrections to the trajectory along each line.");
  v.table("robust", o.adjust.robust, "Weights of single returns.");
  v.table("snooping", o.adjust.snooping, "Search for displaced planes and wrong control.");
  v.table("components", o.adjust.components, "Variances estimated from the residuals.");
  v.option("iterations", o.adjust.iterations, core::within(2, 100), "Most rounds of linearisation.");
}

/// How two lines differ on the planes that both have seen: difference of the mean distances of their returns from the plane, line a minus
/// line b, m.
struct PairOnPlanes {
  int line_a = 0, line_b = 0;  ///< ids; 0: all pairs together
  std::uint64_t planes = 0;
  double mean_before = 0.0, rms_before = 0.0, mean_after = 0.0, rms_after = 0.0;
};

template <class V>
void describe(const PairOnPlanes& r, V& v) {
  const core::Form m = core::metres().always();
  v.result("lines", std::array<int, 2>{r.line_a, r.line_b}, core::plain().only_if(r.line_a != 0 || r.line_b != 0),
           "Numbers of the two lines.");
  v.result("planes", r.planes, "Planes that both have seen.");
  v.result("mean_before", r.mean_before, m, "Mean difference with the trajectory as it was given.");
  v.result("rms_before", r.rms_before, m, "RMS of these differences.");
  v.result("mean_after", r.mean_after, m, "Mean difference with the corrected trajectory.");
  v.result("rms_after", r.rms_after, m, "RMS of these differences.");
}

struct PlaneDifferences {
  std::vector<PairOnPlanes> pairs;  ///< by ids; those with a plane in common
  PairOnPlanes all;
};

template <class V>
void describe(const PlaneDifferences& r, V& v) {
  v.table("all", r.all, "All pairs together.");
  v.tables("pairs", r.pairs, "Pairs of lines with a plane in common.");
}

/// Groups that data snooping took out are left out.
PlaneDifferences plane_differences(const TieSet& ties, const Adjustment& adjustment);

struct AdjustedStrips {
  Adjustment adjustment;
  TieSet ties;  ///< of the last round
  PlaneDifferences differences;
  std::optional<trajectory::Trajectory> trajectory;  ///< corrected; its sigmas, where it has some, are the adjustment's; always set
  int rounds = 0;
  std::vector<std::string> notes;  ///< sentences on how the result came about
};

/// Planes are sought with the trajectory as corrected so far; the adjustment starts from the one that was given, whose errors `errors`
/// shows. Throws core::Error where no two lines see the same planes, where the lines do not agree with one another at all, or only with the
/// sign of the scan angle turned.
AdjustedStrips adjust_strips(const CalibrationFlight& survey, const StripOptions& options, core::Tally& tally,
                             const core::OnProgress& progress = core::unwatched);

/// The trajectory with corrections of its lines; gaps stay gaps.
trajectory::Trajectory with_corrections(const trajectory::Trajectory& trajectory, const std::vector<LineCorrection>& corrections);

}  // namespace swath::calib
