// SPDX-License-Identifier: GPL-3.0-or-later
// The first boresight: what turns the surfaces of the flight lines onto one another, found without points that correspond.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "calib/adjust/adjustment.h"
#include "calib/terms.h"
#include "core/config/option.h"
#include "core/records/sensor.h"
#include "georef/shot_stream.h"
#include "trajectory/fix_window.h"
#include "trajectory/trajectory.h"

namespace swath::calib {

struct SurfaceMatchOptions {
  core::Radians search = core::degrees(0.7);
  std::optional<core::Metres> window, cell;  ///< without them 80 m and 1 m, or less by sized()
  int windows = 500, rounds = 4;
  core::Radians settled = core::degrees(0.01), undetermined = core::degrees(0.1);
  core::Metres position_error{0.1}, height_error{0.2};
  core::Radians attitude_error = core::degrees(0.005);
};

template <class V>
void describe(SurfaceMatchOptions& o, V& v) {
  v.option("search", o.search, core::above_to(0.0, 0.05), "Largest error of each boresight angle at the start that is found.");
  v.option("window", o.window, core::above(0.0),
           "Side of the squares whose surfaces are matched; without it by the height, 80 m from 400 m on.");
  v.option("cell", o.cell, core::above(0.0), "Smallest cell of the surfaces, wider where returns are sparse; without it by the height.");
  v.option("windows", o.windows, core::within(10, 100000), "Most squares with relief that are matched.");
  v.option("rounds", o.rounds, core::within(1, 20), "Most times that the flight is read.");
  v.option("settled", o.settled, core::above(0.0), "Change of all angles below which another round is not needed.");
  v.option("undetermined", o.undetermined, core::above(0.0),
           "Sigma from which on an angle counts as not determined and is left as it was.");
  v.option("position_error", o.position_error, core::above(0.0), "Sigma of a line's horizontal shift by its trajectory.");
  v.option("height_error", o.height_error, core::above(0.0), "Sigma of a line's shift in height.");
  v.option("attitude_error", o.attitude_error, core::above(0.0), "Sigma of a line's turn by its trajectory, about each axis.");
}

/// The options with the sizes that they do not state, for a flight `height` m above the ground (0: not known): a swath from 40 m is
/// narrower than one square of a flight at 700 m.
SurfaceMatchOptions sized(SurfaceMatchOptions options, double height);

/// One square seen by two lines, in the last round.
struct MatchedWindow {
  int line_a = 0, line_b = 0;                          ///< ids
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();    ///< local east, north, m
  bool relief = false;                                 ///< false: level, its height alone was used
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();     ///< of b against a, east north up, m
  Eigen::Vector3d residual = Eigen::Vector3d::Zero();  ///< of that, after the adjustment
  double weight = 0.0;                                 ///< robust, 0 to 1
};

struct SurfaceMatch {
  core::Calibration calibration;                         ///< the start with the angles that were determined
  Eigen::Vector3d change = Eigen::Vector3d::Zero();      ///< of roll, pitch, heading against the start, rad
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< of the change; 0 for angles left as they were, rad^2
  Eigen::Vector3d sigma =
      Eigen::Vector3d::Zero();       ///< of the determined ones its root; of the others what the flight allows (infinite: nothing known)
  std::array<bool, 3> determined{};  ///< roll, pitch, heading
  std::vector<MatchedWindow> windows;
  double agreement = 0.0;  ///< share of the squares with relief whose surfaces meet at the solution of the first round
  double rms = 0.0;        ///< of the shifts' horizontal residuals, weighted, m
  double cell = 0.0;       ///< m, of the last round
  int rounds = 0;
  bool scan_reversed = false;  ///< surfaces meet with the scan angle's sign turned, and not as recorded; the calibration is the start
  std::vector<Finding> findings;
};

/// Roll, pitch and heading of the boresight from the overlaps of flight lines. Surfaces of heights are matched in squares; one boresight is
/// sought that explains all their displacements together, then adjusted robustly with a shift of every line as a nuisance. Nothing else of
/// the calibration is changed. Deterministic.
SurfaceMatch match_surfaces(const ShotStream& stream, const core::Scanner& scanner, const core::Calibration& start,
                            const trajectory::Trajectory& trajectory, const trajectory::LocalFrame& frame,
                            const SurfaceMatchOptions& options = {});

/// Do the surfaces meet with the sign of the scan angle turned, and not as recorded? The test of match_surfaces() by itself, for flights
/// whose boresight is known. False too where nothing determines: no overlap, hardly any relief, or lines on one and the same track alone
/// (each mirrors the ground about it alike). Reads the stream once, a second time where the surfaces do not meet.
bool scan_is_reversed(const ShotStream& stream, const core::Scanner& scanner, const core::Calibration& start,
                      const trajectory::Trajectory& trajectory, const trajectory::LocalFrame& frame,
                      const SurfaceMatchOptions& options = {});

}  // namespace swath::calib
