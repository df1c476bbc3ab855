// SPDX-License-Identifier: GPL-3.0-or-later
// What a calibration's report shows of the points themselves: differences of lines, sections, check points, with the start values and with
// the result.
#pragma once

#include <vector>

#include "calib/ties/check_points.h"
#include "calib/ties/cross_sections.h"
#include "calib/ties/line_heights.h"
#include "stages/stage.h"
#include "trajectory/trajectory.h"

namespace swath::stages {

/// A way to georeference the flight.
struct Geometry {
  const core::Calibration* calibration = nullptr;
  const trajectory::Trajectory* trajectory = nullptr;
};

struct CalibrationViews {
  std::vector<calib::LineDifferenceMap> before, after;  ///< of pairs of lines
  std::vector<calib::SectionPlan> sections;
  std::vector<std::map<int, calib::SectionReturns::OfLine>> sections_before, sections_after;  ///< by section, then line
  std::vector<calib::CheckResidual> checks;                                                   ///< with the result
};

/// Reads the flight once and georeferences it twice. `cell`: for the differences, where the options state none, m. `targets`: those of use
/// `check` are compared with the result.
CalibrationViews view_calibration(const Context& context, const Geometry& before, const Geometry& after, const calib::TieSet& ties,
                                  const std::vector<calib::SurveyedTarget>& targets, const calib::LineHeightOptions& heights, double cell,
                                  size_t sections);

}  // namespace swath::stages
