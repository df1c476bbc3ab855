// SPDX-License-Identifier: GPL-3.0-or-later
// A sample of a flight under one set of assumptions: how well its lines fit, and what its returns and its trajectory contradict.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calib/geometry/geometry_pairs.h"
#include "calib/geometry/geometry_sample.h"
#include "calib/geometry/roll_signal.h"
#include "calib/geometry/small_errors.h"
#include "calib/geometry/usual_mistakes.h"
#include "core/config/result.h"
#include "core/records/sensor.h"
#include "trajectory/flight_checks.h"
#include "trajectory/motion_checks.h"
#include "trajectory/trajectory.h"

namespace swath::calib {

/// m: ground itself differs by this from pass to pass.
inline constexpr double finest_difference = 0.03;

/// How the lines fit together.
struct Fit {
  std::uint64_t cells = 0;
  double rms = 0.0;      ///< robust, of the pairs by their cells, m
  double outside = 0.0;  ///< share of shared cells off by five predicted sigmas
  double cost = 0.0;     ///< root of the mean square, each difference cut at twenty sigmas, m
  double smooth = 0.0;   ///< share of cells that are smooth
};

template <class V>
void describe(const Fit& r, V& v) {
  v.result("cells", r.cells, "Cells that two lines share.");
  v.result("rms_m", r.rms, core::metres().always(), "Robust RMS of the differences.");
  v.result("outside", r.outside, core::share().always(), "Share of shared cells that are off by five predicted sigmas.");
  v.result("cost", r.cost, core::metres().always(), "Root mean square of the differences, each cut at twenty sigmas.");
  v.result("smooth", r.smooth, core::share().always(), "Share of cells that are smooth.");
}

/// What is looked at beside the lines' fit.
struct GeometryCheck {
  std::string name;    ///< "ground_height"
  double value = 0.0;  ///< in the unit of the text
  bool held = true;
  std::string text;   ///< a sentence with figures, where it is not held
  bool said = false;  ///< trajectory::MotionChecks warns of the same
};

template <class V>
void describe(const GeometryCheck& r, V& v) {
  v.result("value", r.value, core::plain().always(), "Figure that is judged.");
  v.result("held", r.held, "False: it contradicts the stated sigmas.");
}

/// A surveyed height on the ground.
struct SurveyedHeight {
  Eigen::Vector3d place;    ///< local frame of the flight, m
  double sigma = 0.0;       ///< of the height, m
  double horizontal = 0.0;  ///< sigma of each horizontal coordinate, m
};

/// The fixed part: what the flight gave.
struct SampledFlight {
  std::vector<SurveyedHeight> control;
  SamplePlan plan;
  GeometrySample sample;
  trajectory::LocalFrame frame;
  GroundOptions ground;
  core::SensorSigma sensor;
};

/// Pairs of lines with their figures, and over all.
struct LineFit {
  std::vector<LinePair> pairs;
  Fit fit;
  double predicted = 0.0;  ///< m, over all pairs
};

/// The smooth ground of a sample under one set of assumptions.
struct LineCells {
  std::vector<PassGround> ground;
  std::vector<PairCells> pairs;
  std::vector<ControlCell> control;
};
LineCells line_cells(const SampledFlight& flight, const Chain& chain, const trajectory::Trajectory& trajectory);

/// `predicted`: taken for all pairs where it is not 0; else it is computed. Takes water out of the cells.
LineFit fit_lines(const SampledFlight& flight, LineCells& cells, const Chain& chain, const trajectory::Trajectory& trajectory,
                  double predicted);

/// Of returns: do the beams point down, is the ground at a height where land is, does the ground tilt with the roll.
std::vector<GeometryCheck> check_returns(const SampledFlight& flight, const Chain& chain, const trajectory::Trajectory& trajectory,
                                         const core::TrajectoryData& data);
/// Of the trajectory alone. `said`: what its reader has warned of.
std::vector<GeometryCheck> check_motion(const trajectory::FlightChecks& checks, const trajectory::MotionChecks& said = {});

}  // namespace swath::calib
