// SPDX-License-Identifier: GPL-3.0-or-later
// Surveyed control: points, and targets (roofs and other planes) given by their corners.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/geo/crs.h"
#include "core/report.h"
#include "io/survey/control_file.h"

namespace swath::io {

struct Survey;

/// One surveyed point in ecef.
struct ControlPoint {
  std::string name;
  std::string target;    ///< the plane it is a corner of; empty: a point of its own on the ground
  Eigen::Vector3d ecef;  ///< m
  double sigma_h = 0.0;  ///< m, of each horizontal coordinate
  double sigma_v = 0.0;  ///< m
  ControlUse use = ControlUse::control;
  std::string place;    ///< "file:line"
  std::string cover{};  ///< what covers the ground; empty: not stated
  ControlKind kind = ControlKind::xyz;
  bool is_named = true;                            ///< false: its name is a number by its place, or of the target's corner
  core::Heights heights = core::Heights::unknown;  ///< what its file's height counted from, by its CRS
};

/// All control of a survey that has three coordinates, in the files' order; corners of one target adjacent and in their order. Throws Error
/// with file and line: columns missing, values not finite, a target of fewer than three corners or of corners in one line, a CRS without an
/// operation to WGS84.
std::vector<ControlPoint> read_control(const Survey& survey, core::Tally& tally);
/// The same, and of files that hold plan or heights alone: images can use them, a laser cannot.
std::vector<ControlPoint> read_image_control(const Survey& survey, core::Tally& tally);

}  // namespace swath::io
