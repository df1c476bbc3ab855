// SPDX-License-Identifier: GPL-3.0-or-later
// `swath budget`: the errors of a survey's points by source, at any height, scan angle and slope.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/config/result.h"
#include "planning/flight_plan.h"

namespace swath::pipeline {

struct BudgetRequest {
  std::filesystem::path survey;       ///< survey.toml
  double height = 0.0;                ///< m above the ground
  std::vector<double> angles{0.0};    ///< rad
  double speed = 0.0;                 ///< m/s, for errors of time
  double slope = 0.0;                 ///< rise / run, across the track
  std::optional<double> penetration;  ///< share of the pulses that reach the ground under trees
};

/// What the errors come to at one scan angle.
struct SurfaceFound {
  double angle = 0.0;                       ///< rad
  double horizontal = 0.0, vertical = 0.0;  ///< m: of the point, radial and in height
  double surface = 0.0;                     ///< m: of the slope's height
};
template <class V>
void describe(const SurfaceFound& s, V& v) {
  v.result("scan_angle_deg", core::to_degrees(s.angle), core::in_degrees(1), "Scan angle.");
  v.result("sigma_horizontal_m", s.horizontal, core::metres(3), "Radial sigma of the point's place.");
  v.result("sigma_vertical_m", s.vertical, core::metres(3), "Sigma of the point's height.");
  v.result("sigma_surface_m", s.surface, core::metres(3), "Sigma of the height of ground with that slope.");
}

struct BudgetTable {
  std::string trajectory;  ///< where the trajectory's sigmas are from
  double slope = 0.0;
  std::vector<planning::BudgetFound> budget;
  std::vector<SurfaceFound> surface;
  std::optional<double> forest;  ///< m
};
template <class V>
void describe(const BudgetTable& t, V& v) {
  v.result("trajectory", t.trajectory, "Where the sigmas of the trajectory are from.");
  v.result("slope", t.slope, "Slope across the track, rise / run.");
  v.tables("budget", t.budget, "Errors by source.");
  v.tables("points", t.surface, "All sources together.");
  v.result("forest_sigma_m", t.forest, core::metres(2), "Sigma of terrain heights under forest (Brandalize (15)).");
}

/// From the survey's [sigma] and calibration_file, and the sigmas that its trajectory files state (rms over their records; without any, 2
/// cm, 3 cm, 0.0025 deg and 0.005 deg). Throws core::Error: the survey's faults, a height that is not above 0, an angle of 80 deg or more,
/// a penetration below 25 %, which (15) is not for.
BudgetTable budget_of(const BudgetRequest& request);
std::string budget_text(const BudgetTable& table);

}  // namespace swath::pipeline
