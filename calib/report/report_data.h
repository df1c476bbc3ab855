// SPDX-License-Identifier: GPL-3.0-or-later
// What a calibration's report is made of.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "calib/adjust/adjustment.h"
#include "calib/adjust/strips.h"
#include "calib/ties/tie_set.h"
#include "core/config/value.h"
#include "core/grid.h"
#include "core/records/sensor.h"
#include "report/chart.h"
#include "report/page.h"

namespace swath::calib {

/// A flight line as it was flown.
struct ReportedLine {
  int id = 0;
  std::string name;
  double heading = 0.0;            ///< mean course over ground, from true north, rad, [0, 2 pi)
  double height = 0.0;             ///< mean of the scanner above the ground, m
  double speed = 0.0;              ///< mean over ground, m/s
  double length = 0.0;             ///< m
  double first = 0.0, last = 0.0;  ///< GPS time, s
  std::uint64_t returns = 0;       ///< read
};

/// Returns of one line near a vertical section.
struct SectionPoints {
  int line = 0;                       ///< id
  std::vector<double> along, height;  ///< m, from the section's first end; m, of the survey's CRS
};

/// A vertical cut through a target or a steep roof, with the start values and with the result.
struct CrossSection {
  std::string name;                     ///< "gable 14, along line 3"
  double width = 0.0;                   ///< of the strip whose returns are shown, m
  std::array<Eigen::Vector2d, 2> ends;  ///< map, m: where `along` is 0, and the other
  std::vector<SectionPoints> before, after;
};

/// Heights of line a minus heights of line b on one lattice (map, m); NaN where the two do not meet or the ground is not smooth.
struct LineDifference {
  int line_a = 0, line_b = 0;  ///< ids
  core::Grid before, after;    ///< one lattice; `height` is the difference, m
};

/// The same parameter found on another way: a reading of the flat-target analysis.
struct TargetReading {
  calib::Parameter parameter = calib::boresight_roll;
  double value = 0.0, sigma = 0.0;  ///< as calib::Estimate: m, rad, s, none
  std::uint64_t readings = 0;       ///< it is the mean of
  std::string note;                 ///< "lines 1 and 2, profiles"; may be empty
};

/// What a calibration was made from.
struct ReportOrigin {
  std::string program;               ///< with its version
  std::string flown_from, flown_to;  ///< UTC of the first and last return; empty where the week is not known
  std::vector<std::string> inputs;   ///< "laser: laser.npy", in the survey's order
};

/// A part of the page that one kind of adjustment alone has.
struct ReportSection {
  struct Figure {
    std::string name;  ///< of the file, without folder and ending
    report::Chart chart;
    std::string caption;
  };
  std::string heading;
  std::vector<std::string> paragraphs;
  std::vector<report::Table> tables;
  std::vector<Figure> figures;
};

struct CalibrationReport {
  std::string survey;  ///< name
  ReportOrigin origin;
  std::string crs;                         ///< of sections and differences, as io::write_grid takes it
  double unit = 1.0, vertical_unit = 1.0;  ///< metres per unit of that CRS, for the GeoTIFFs; all else here is in m
  core::SensorSigma sensor;                ///< as the survey states it: what is not estimated keeps its sigma in calibration.json
  calib::Adjustment adjustment;
  calib::TieSet ties;  ///< its returns are not used and may be left out
  std::vector<ReportedLine> lines;
  std::vector<CrossSection> sections;
  std::vector<LineDifference> differences;
  std::vector<calib::ControlResidual> checks;  ///< surveyed points that took no part: height of the returns minus that of the point
  std::vector<TargetReading> readings;         ///< of the flat-target analysis; empty: there was none
  core::Value flat_target;                     ///< its details: a table of numbers and texts, or of lists of such tables; null: none
  std::vector<std::string> notes;              ///< further sentences for the reader ("start values were found from height grids")
  /// Set: the report is of a strip adjustment, no calibration value is estimated, and strips.json takes the place of calibration.json.
  std::optional<calib::PlaneDifferences> strips;
  /// With `strips`: of a joint adjustment, which estimates the trajectory from its records and perhaps calibration values; adjustment.json
  /// takes the place of strips.json.
  bool joint = false;
  std::vector<ReportSection> sections_of_joint;
};

}  // namespace swath::calib
