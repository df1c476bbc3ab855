// SPDX-License-Identifier: GPL-3.0-or-later
// Do overlapping lines differ by more than the stated errors of trajectory and calibration make them differ?
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "calib/adjust/correction_knots.h"
#include "calib/ties/tie_set.h"
#include "core/config/result.h"
#include "core/records/sensor.h"
#include "trajectory/trajectory.h"

namespace swath::calib {

/// Two lines on the planes that both have seen: line a minus line b along the normals, m.
struct PairAgreement {
  int line_a = 0, line_b = 0;  ///< ids
  std::uint64_t planes = 0;
  double mean = 0.0, rms = 0.0;
  double predicted = 0.0;  ///< rms that the sigmas make one expect
  double surplus = 0.0;    ///< how improbable the rms is beside that: a standard normal deviate
};

template <class V>
void describe(const PairAgreement& r, V& v) {
  const core::Form m = core::metres().always();
  v.result("lines", std::array<int, 2>{r.line_a, r.line_b}, "Numbers of the two lines.");
  v.result("planes", r.planes, "Planes that both have seen.");
  v.result("mean", r.mean, m, "Mean difference along the normals, first line less second.");
  v.result("rms", r.rms, m, "RMS of the differences.");
  v.result("predicted", r.predicted, m, "RMS that the stated sigmas predict.");
  v.result("surplus", r.surplus, core::plain().always(), "How improbable the RMS is beside it, as a standard normal deviate.");
}

struct LineAgreement {
  std::vector<PairAgreement> pairs;  ///< by ids
  std::uint64_t planes = 0;          ///< differences of all pairs
  double rms = 0.0, predicted = 0.0;
  /// A pair differs by more than 3.5 of those deviates (probability 2e-4 each where the sigmas are true).
  bool exceeded() const;
};

template <class V>
void describe(const LineAgreement& r, V& v) {
  const bool any = !r.pairs.empty();
  v.result("planes", r.planes, core::plain().only_if(any), "Differences of all pairs.");
  v.result("rms", r.rms, core::metres().always().only_if(any), "RMS of all differences.");
  v.result("predicted", r.predicted, core::metres().always().only_if(any), "RMS that the stated sigmas predict.");
  v.tables_if(any, "pairs", r.pairs, "Pairs of lines with a plane in common.");
}

/// The differences with the trajectory and calibration as they are. Predicted variances: errors of the trajectory with their correlation in
/// time (`errors`), those of the calibration (sigmas and correlations of `sensor`), and the scatter of the returns. Up to 25 planes of a
/// pair, evenly chosen, are judged together: their sum of squares, by trace and trace of the square of its covariance, is a scaled
/// chi-square (Satterthwaite 1946), whose cube root is normal (Wilson and Hilferty 1931). No pair where no plane is shared.
LineAgreement line_agreement(const TieSet& ties, const core::Scanner& scanner, const core::Calibration& calibration,
                             const core::SensorSigma& sensor, const trajectory::Trajectory& trajectory, const ErrorCovariance& errors);

}  // namespace swath::calib
