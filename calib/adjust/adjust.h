// SPDX-License-Identifier: GPL-3.0-or-later
// The rigorous adjustment of a calibration flight or of a survey's strips: returns of several lines lie on common planes.
#pragma once

#include "calib/adjust/adjust_options.h"
#include "calib/adjust/adjustment.h"
#include "calib/adjust/correction_knots.h"
#include "trajectory/ins/error_model.h"
#include "trajectory/trajectory.h"

namespace swath::calib {

/// How far the trajectory's covariances between instants are known.
enum class ErrorShape {
  known,    ///< from the smoother that made it
  guessed,  ///< sigmas with a correlation time: means, drifts and what is within a line have factors of their own
};

/// Estimates calibration values, corrections of the trajectory along each line and the planes, from the returns of `ties` through the
/// equation of georef/shot_geometry.h. `noise`: sigmas of single records (range, scan_angle, beam_divergence, time). `covariance`: of the
/// trajectory's errors. Groups of ties must be ordered by plane. The result does not depend on the number of threads.
///
/// The delivered sigma of a value is the formal one - from the inverse of the normal equations of all unknowns, the trajectory's errors
/// correlated as `covariance` says and scaled by the variances found - or the jackknife's over lines (four at least) where that is larger,
/// or more where leaving out regions moves the value significantly more than these covariances allow (calib/adjust/jackknife.h); with what
/// the sigmas of `noise` for the calibration values that are held (the lever arm, as a rule) do to it. A value that the flight does not
/// determine (Finding::refuses) is delivered as it started, with its a-priori sigma; it stays an unknown, so that the others' sigmas hold
/// its uncertainty. A start value that the flight contradicts (calib/adjust/start_sigmas.h) counts for nothing.
Adjustment adjust(const TieSet& ties, const core::Scanner& scanner, const core::Calibration& start, const core::SensorSigma& noise,
                  const trajectory::Trajectory& trajectory, const ErrorCovariance& covariance, const AdjustOptions& options,
                  int threads = 1, ErrorShape shape = ErrorShape::known);

inline Adjustment adjust(const TieSet& ties, const core::Scanner& scanner, const core::Calibration& start, const core::SensorSigma& noise,
                         const trajectory::Trajectory& trajectory, const trajectory::ErrorModel& errors, const AdjustOptions& options,
                         int threads = 1) {
  return adjust(
      ties, scanner, start, noise, trajectory, [&errors](const std::vector<double>& t) { return errors.covariance(t); }, options, threads,
      errors.is_of_smoother() ? ErrorShape::known : ErrorShape::guessed);
}

}  // namespace swath::calib
