// SPDX-License-Identifier: GPL-3.0-or-later
// A whole calibration: coarse boresight from surfaces, planes, adjustment, and planes again until nothing changes.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calib/adjust/adjust.h"
#include "calib/adjust/adjustment.h"
#include "calib/terms.h"
#include "calib/ties/control.h"
#include "calib/ties/surface_match.h"
#include "calib/ties/tie_planes.h"
#include "core/on_progress.h"
#include "georef/shot_stream.h"
#include "trajectory/ins/error_model.h"
#include "trajectory/trajectory.h"

namespace swath::calib {

struct CalibrateOptions {
  CalibrateOptions() { planes.mismatch.value = 0.5; }
  bool coarse = true;
  int rounds = 12;
  SurfaceMatchOptions match;
  TiePlaneOptions planes;
  AdjustOptions adjust;
};

template <class V>
void describe(CalibrateOptions& o, V& v) {
  v.option("coarse", o.coarse, "Find first boresight values by matching surfaces; otherwise take those of the survey.");
  v.option("rounds", o.rounds, core::within(3, 20), "Maximum number of rounds; they end where no value moves by half of its sigma.");
  v.table("match", o.match, "The surfaces' matching.");
  v.table("planes", o.planes, "The search for planes; `mismatch` is that of the first round, 1/800 of the height at most.");
  describe(o.adjust, v);
}

/// What is calibrated. Pointers must outlive the call.
struct CalibrationFlight {
  ShotStream shots;
  core::Scanner scanner;
  core::Calibration start;
  core::SensorSigma sensor;  ///< of single records: range, scan_angle, beam_divergence
  const trajectory::Trajectory* trajectory = nullptr;
  const trajectory::ErrorModel* errors = nullptr;
  trajectory::LocalFrame frame;
  FlownScale scale;                     ///< sizes of planes and squares follow it
  std::vector<SurveyedTarget> targets;  ///< those of use `control` take part
  int threads = 1;
};

struct Calibrated {
  Adjustment adjustment;
  TieSet ties;                        ///< of the last round
  std::optional<SurfaceMatch> match;  ///< of the coarse step, where there was one
  int rounds = 0;
  std::vector<std::string> notes;  ///< sentences on how the result came about
};

/// What find_tie_planes() counted of surveyed targets that no line shows, as sentences.
std::vector<std::string> targets_not_found(const core::Tally& tally);

/// A frame amid the flight, at its ground: the mean place of the lines' middles, `height` m below.
trajectory::LocalFrame frame_of(const std::vector<std::pair<double, double>>& line_times, double height,
                                const trajectory::Trajectory& trajectory);

/// Throws core::Error where the surfaces of the lines meet only with the sign of the scan angle turned (scan_is_reversed());
/// an IMU turned by 180 deg about the vertical, which looks alike, is named where the body flies backwards.
void refuse_reversed_scan(const CalibrationFlight& flight, const SurfaceMatchOptions& options = {});

/// Throws core::Error where the flight cannot be calibrated at all: no two lines that see the same planes (and no target), or records of
/// the scan angle with the wrong sign. Values that still move by more than half of their sigma after the last round are not delivered.
Calibrated calibrate(const CalibrationFlight& flight, const CalibrateOptions& options, core::Tally& tally,
                     const core::OnProgress& progress = core::unwatched);

}  // namespace swath::calib
