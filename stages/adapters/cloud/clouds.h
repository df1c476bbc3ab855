// SPDX-License-Identifier: GPL-3.0-or-later
// The survey's point clouds, as reader and writer see them.
#pragma once

#include <optional>
#include <vector>

#include "io/las/las_crs.h"
#include "io/las/las_source.h"
#include "stages/stage.h"

namespace swath::stages {

/// How coordinates of a cloud's file become those of the run.
struct CloudPlace {
  std::optional<core::Transform> transform;
  double file_height_unit = 1.0;  ///< of the map's vertical unit, or metres where there is a transformation
  double map_height_unit = 1.0;
  bool is_same() const { return !transform && file_height_unit == 1.0; }
};
CloudPlace place_of(const Context& context, const io::PointFile& file, const io::LasCrs& stated);

/// How times of a cloud's file are read: those of an unknown scale stay as they are.
io::LasTime times_of(const io::PointFile& file);

/// The files of the survey's clouds, in its order.
std::vector<io::LasSource> cloud_sources(const Context& context);

/// Do all files state the CRS of the run themselves, in units of theirs?
bool keeps_crs(const Context& context, const std::vector<io::LasSource>& sources);

}  // namespace swath::stages
