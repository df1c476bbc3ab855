// SPDX-License-Identifier: GPL-3.0-or-later
// What the geometry of a flight is judged from, and what is found.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calib/geometry/geometry_fit.h"
#include "core/config/option.h"
#include "core/config/result.h"
#include "core/records/sensor.h"
#include "trajectory/trajectory.h"

namespace swath::calib {

struct GeometryOptions {
  double ratio = 4.0;
  core::Metres tolerance{0.2};
  double outside = 0.15;
  int min_cells = 30;
  int returns = 12000;
  int stretches = 64;
};

template <class V>
void describe(GeometryOptions& o, V& v) {
  v.option("ratio", o.ratio, core::above(1), "Lines are inconsistent where they differ by more than this many predicted sigmas ...");
  v.option("tolerance", o.tolerance, core::at_least(0), "... and by more than this distance.");
  v.option("outside", o.outside, core::within(0, 1), "Or where more than this share of their common ground is off by five such sigmas.");
  v.option("min_cells", o.min_cells, core::within(5, 100000), "Smallest number of common smooth cells that a pair of lines is judged by.");
  v.option("returns", o.returns, core::within(1000, 1000000), "Returns of one stretch of a line that are looked at.");
  v.option("stretches", o.stretches, core::within(4, 1000), "Maximum number of stretches in a survey.");
}

/// A surveyed height on the ground.
struct SurveyedPlace {
  Eigen::Vector3d ecef;     ///< m
  double sigma = 0.0;       ///< of the height, m
  double horizontal = 0.0;  ///< sigma of each horizontal coordinate, m
};

/// What is judged. The trajectory must outlive the call.
struct GeometryInput {
  ShotStream shots;
  std::vector<RecordedLine> lines;
  Chain chain;
  core::SensorSigma sensor;
  const trajectory::Trajectory* trajectory = nullptr;
  double range = 0.0;                                 ///< m, median of some returns
  double convergence = 0.0;                           ///< rad, as usual_mistakes()
  Eigen::Vector3d antenna = Eigen::Vector3d::Zero();  ///< m, its lever arm, as usual_mistakes()
  std::vector<SurveyedPlace> control;
  bool control_over_geoid = false;     ///< its heights are stated to count from a geoid or level
  std::function<double()> undulation;  ///< of the geoid above the ellipsoid, m; NaN, or empty: not known
};

enum class Verdict { not_judged, consistent, inconsistent };

/// A mistake that was tried.
struct TriedMistake {
  std::string name, what, cure;
  Fit fit;
  size_t contradictions = 0;  ///< checks that are not held with it
  bool usual = true;          ///< a sign, a unit, an axis, whole seconds: no value was fitted
};

template <class V>
void describe(const TriedMistake& r, V& v) {
  describe(r.fit, v);
  v.result("name", r.name, "Name of the mistake (docs/run.md).");
  v.result("what", r.what, "What was tried.");
  v.result("contradictions", r.contradictions, "Checks that are not held with it.");
}

/// Control near the lines.
struct ControlNear {
  size_t points = 0, near = 0, compared = 0;
  double nearest = 0.0;                  ///< m, from a track
  double median = 0.0, predicted = 0.0;  ///< ground less control, m
};

template <class V>
void describe(const ControlNear& r, V& v) {
  v.result("points", r.points, "Surveyed points.");
  v.result("near", r.near, "Of those: near a flight line.");
  v.result("compared", r.compared, "Of those: compared with the ground beside them.");
  v.result("nearest_m", r.nearest, core::metres(0), "Distance of the nearest point from a track.");
  v.result("median_m", r.median, core::metres().only_if(r.compared > 0), "Median of ground less control.");
  v.result("predicted_m", r.predicted, core::metres().only_if(r.compared > 0), "Difference that the stated sigmas predict.");
}

struct GeometryFigures {
  Verdict verdict = Verdict::not_judged;
  LineFit lines;
  double covered = 0.0;  ///< share of the lines' time within the trajectory
  std::vector<GeometryCheck> checks;
  ControlNear control;
  std::vector<TriedMistake> tried;
  std::vector<TriedMistake> named;        ///< those that explain what was found, the best first
  std::vector<std::string> warnings;      ///< sentences with figures
  std::string doubt;                      ///< why lines are not to be adjusted as they are: the cause lies elsewhere; empty: nothing
  std::optional<double> line_difference;  ///< largest RMS difference of two lines with enough smooth ground, m
};

template <class V>
void describe(const GeometryFigures& r, V& v) {
  constexpr const char* verdicts[] = {"not judged", "consistent", "inconsistent"};
  std::vector<std::string> named;
  for (const TriedMistake& t : r.named) named.push_back(t.name);
  // What the trajectory's reader has warned of is not said again, but counts.
  std::uint64_t contradictions = r.warnings.size();
  std::vector<std::pair<std::string, GeometryCheck>> checks;
  for (const GeometryCheck& c : r.checks) contradictions += !c.held && c.said, checks.emplace_back(c.name, c);
  v.result("verdict", std::string(verdicts[static_cast<size_t>(r.verdict)]), core::plain().in_summary(),
           "consistent, inconsistent, or not judged.");
  v.result("named", named, core::plain().in_summary(), "Mistakes that explain what was found, the best first.");
  v.result("line_difference", r.line_difference, core::metres().in_summary().limited_by("line_difference"),
           "Largest RMS difference of two lines on smooth ground.");
  v.table("control", r.control.points > 0 ? std::optional(r.control) : std::nullopt, "Surveyed heights near the lines.");
  v.result("contradictions", contradictions, core::plain().in_summary().limited_by("contradictions"),
           "Warnings, and checks that the trajectory's reader has warned of.");
  v.result("covered", r.covered, core::share().always(), "Share of the lines' time within the trajectory.");
  v.result("predicted_m", r.lines.predicted, core::metres().always(), "Difference of two lines that the stated sigmas predict.");
  v.table("fit", r.lines.fit, "How the lines fit as they are.");
  v.tables("pairs", r.lines.pairs, "Pairs of lines that share smooth ground.");
  v.named_tables("checks", checks, "Checks by name.");
  v.tables("tried", r.tried, "Mistakes that were tried.");
  v.result("doubt", r.doubt.empty() ? std::nullopt : std::optional(r.doubt), core::plain().in_summary(),
           "Why the lines are not to be adjusted as they are.");
  v.result("warnings", r.warnings, "Sentences with figures.");
}

}  // namespace swath::calib
