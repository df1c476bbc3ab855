// SPDX-License-Identifier: GPL-3.0-or-later
// `swath profile --stations`: sections across an axis, with what a design takes away and heaps up.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/config/result.h"
#include "pipeline/profile.h"

namespace swath::pipeline {

struct CrossSectionRequest {
  ProfileRequest axis;               ///< dtm, lines (or from, to) and folder; points are not read
  std::filesystem::path design;      ///< raster; empty: `level`, or none
  std::optional<double> level;       ///< of a level design, unit of the dtm's heights
  double step = 20.0, width = 40.0;  ///< m: from station to station, of a section
};

/// All sections of one axis. m, m2, m3, or units of a file without CRS.
struct AxisSections {
  std::string name;
  std::size_t sections = 0, incomplete = 0;
  double length = 0.0, cut = 0.0, fill = 0.0;
};
template <class V>
void describe(const AxisSections& a, V& v) {
  v.result("name", a.name, "Name of the axis.");
  v.result("length", a.length, "Length from the first to the last station.");
  v.result("sections", a.sections, "Sections across it.");
  v.result("incomplete", a.incomplete, "Sections of which a part has no height of terrain or design.");
  v.result("cut", a.cut, "Volume that the design takes away, by average end areas.");
  v.result("fill", a.fill, "Volume that it heaps up.");
}

/// FOLDER/sections.csv (a row per section: axis, station, place, bearing, heights on the axis, areas, volumes since the section before) and
/// FOLDER/section_points.csv (both surfaces every half cell across). Stations are whole steps from the axis' start, and its end. Volumes
/// are the mean of two end areas times their distance: right for straight axes; in a bend of radius R off by the share e / R, e the
/// distance of the area's middle from the axis. Throws core::Error: surfaces in different CRSs, no section that meets the terrain.
std::vector<AxisSections> write_cross_sections(const CrossSectionRequest& request);

}  // namespace swath::pipeline
