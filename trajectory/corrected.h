// SPDX-License-Identifier: GPL-3.0-or-later
// A trajectory with corrections that a calibration or a strip adjustment found.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "core/records/trajectory_data.h"

namespace swath::trajectory {

/// What is to be added to one stretch of a trajectory, as a flight line: linear between its knots.
struct CorrectionSeries {
  using Six = std::array<double, 6>;  ///< north, east, down (m), roll, pitch, heading (rad)
  struct Knot {
    double time = 0.0;  ///< GPS time, s
    Six value{};
    std::optional<Six> sigma;                                     ///< of the trajectory with the correction, where it is known
    std::optional<core::CalibrationResponse::Matrix> response{};  ///< of `value` to the calibration that was held, where it is known
  };
  std::vector<Knot> knots;  ///< rising in time, one at least
};

/// The corrections of all stretches as a function of time: between two stretches linear from the last knot of one to the first of the next,
/// before the first knot of all and after the last as there.
class CorrectionCurve {
 public:
  struct Value {
    CorrectionSeries::Six value{}, rate{};       ///< rate: of value, per second
    std::optional<CorrectionSeries::Six> sigma;  ///< linear, where both knots about the instant have one
  };
  /// Stretches in any order. Throws core::Error{where: "correction N"} where a stretch has no knots, a number is not finite, or knots of
  /// one stretch or of all do not rise in time.
  explicit CorrectionCurve(std::vector<CorrectionSeries> corrections);
  /// Zeros without any stretch.
  Value at(double time) const;

 private:
  std::vector<CorrectionSeries::Knot> knots_;
};

/// Positions moved along the local axes, angles added (heading stays within [0, 2 pi)), velocities changed by the derivative of the
/// position's correction. Sigmas are replaced where the corrections state them; those columns are left out where the trajectory has none.
/// Covariances and error links are those of the trajectory as it was: they stay only where nothing is corrected. The response to the
/// calibration is that of the corrections, where all their knots state it.
core::TrajectoryData corrected(const core::TrajectoryData& trajectory, const std::vector<CorrectionSeries>& corrections);

}  // namespace swath::trajectory
