// SPDX-License-Identifier: GPL-3.0-or-later
// The geometry of a flight judged before anything is made of it: what report.json says of it.
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calib/geometry/geometry_gate.h"
#include "core/config/result.h"
#include "stages/once.h"

namespace swath::calib {

template <class V>
void describe(const Fit& r, V& v) {
  v.result("cells", r.cells, "Cells that two lines share.");
  v.result("rms_m", r.rms, core::metres().always(), "Robust RMS of the differences.");
  v.result("outside", r.outside, core::share().always(), "Share of shared cells that are off by five predicted sigmas.");
  v.result("cost", r.cost, core::metres().always(), "Root mean square of the differences, each cut at twenty sigmas.");
  v.result("smooth", r.smooth, core::share().always(), "Share of cells that are smooth.");
}

template <class V>
void describe(const LinePair& r, V& v) {
  v.result("lines", std::array<int, 2>{r.line_a, r.line_b}, "Numbers of the two flight lines.");
  v.result("n", r.cells, "Cells that they share.");
  v.result("median_m", r.median, core::metres().always(), "Median difference along the normal.");
  v.result("rms_m", r.rms, core::metres().always(), "Robust RMS of the differences.");
  v.result("predicted_m", r.predicted, core::metres().always(), "Difference that the stated sigmas predict.");
  v.result("outside", r.outside, core::share().always(), "Share of cells that differ by more than five of those.");
  v.result("water_m", r.water, core::metres(2).only_if(r.water != 0.0), "Difference of level ground that is taken for water, left out.");
}

template <class V>
void describe(const ControlNear& r, V& v) {
  v.result("points", r.points, "Surveyed points.");
  v.result("near", r.near, "Of those: near a flight line.");
  v.result("compared", r.compared, "Of those: compared with the ground beside them.");
  v.result("nearest_m", r.nearest, core::metres(0), "Distance of the nearest point from a track.");
  v.result("median_m", r.median, core::metres().only_if(r.compared > 0), "Median of ground less control.");
  v.result("predicted_m", r.predicted, core::metres().only_if(r.compared > 0), "Difference that the stated sigmas predict.");
}

template <class V>
void describe(const GeometryCheck& r, V& v) {
  v.result("value", r.value, core::plain().always(), "Figure that is judged.");
  v.result("held", r.held, "False: it contradicts the stated sigmas.");
}

template <class V>
void describe(const TriedMistake& r, V& v) {
  describe(r.fit, v);
  v.result("name", r.name, "Name of the mistake (docs/run.md).");
  v.result("what", r.what, "What was tried.");
  v.result("contradictions", r.contradictions, "Checks that are not held with it.");
}

}  // namespace swath::calib

namespace swath::stages {

struct GeometryReport {
  std::string verdict;
  std::vector<std::string> named;
  std::optional<double> line_difference{};
  std::optional<calib::ControlNear> control{};
  std::uint64_t contradictions = 0;
  double covered = 0.0, predicted = 0.0;
  calib::Fit fit{};
  std::vector<calib::LinePair> pairs{};
  std::vector<std::pair<std::string, calib::GeometryCheck>> checks{};
  std::vector<calib::TriedMistake> tried{};
  std::optional<std::string> doubt{};
  std::vector<std::string> warnings{};
};

template <class V>
void describe(const GeometryReport& r, V& v) {
  v.result("verdict", r.verdict, core::plain().in_summary(), "consistent, inconsistent, or not judged.");
  v.result("named", r.named, core::plain().in_summary(), "Mistakes that explain what was found, the best first.");
  v.result("line_difference", r.line_difference, core::metres().in_summary().limited_by("line_difference"),
           "Largest RMS difference of two lines on smooth ground.");
  v.table("control", r.control, "Surveyed heights near the lines.");
  v.result("contradictions", r.contradictions, core::plain().in_summary().limited_by("contradictions"),
           "Warnings, and checks that the trajectory's reader has warned of.");
  v.result("covered", r.covered, core::share().always(), "Share of the lines' time within the trajectory.");
  v.result("predicted_m", r.predicted, core::metres().always(), "Difference of two lines that the stated sigmas predict.");
  v.table("fit", r.fit, "How the lines fit as they are.");
  v.tables("pairs", r.pairs, "Pairs of lines that share smooth ground.");
  v.named_tables("checks", r.checks, "Checks by name.");
  v.tables("tried", r.tried, "Mistakes that were tried.");
  v.result("doubt", r.doubt, core::plain().in_summary(), "Why the lines are not to be adjusted as they are.");
  v.result("warnings", r.warnings, "Sentences with figures.");
}

struct GeometryFindings {
  GeometryReport geometry;
};

template <class V>
void describe(const GeometryFindings& r, V& v) {
  v.table("geometry", r.geometry, "The judgement; in report.json it is the key geometry of the whole report.");
}

GeometryFindings judge_flight(const Context& context, const trajectory::Trajectory& trajectory, const core::GnssData* fixes,
                              const georef::ShotStream& shots, const calib::GeometryOptions& o, core::Tally& tally);

}  // namespace swath::stages
