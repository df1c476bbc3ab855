// SPDX-License-Identifier: GPL-3.0-or-later
// `swath volumes --levels`: what a terrain holds below each of some levels, as a reservoir's curve of level, area and volume.
#pragma once

#include <string>
#include <vector>

#include "core/config/result.h"
#include "pipeline/volume_files.h"

namespace swath::pipeline {

/// A level surface over the terrain; m, m2, m3, or units of the file.
struct LevelRow {
  double level = 0.0;  ///< unit of the file's heights
  double area = 0.0, volume = 0.0;
  double sigma = 0.0;  ///< of the volume; not a number where the model has none
};
template <class V>
void describe(const LevelRow& r, V& v) {
  v.result("level", r.level, "Height of the level.");
  v.result("area", r.area, "Area of terrain below it.");
  v.result("volume", r.volume, "Volume between terrain and level.");
  v.result("sigma_volume", r.sigma, core::plain().only_if(std::isfinite(r.sigma)), "Standard deviation of the volume.");
}

struct LevelCurve {
  VolumesFound last;  ///< of the highest level: what was compared
  std::vector<LevelRow> rows;
};
template <class V>
void describe(const LevelCurve& c, V& v) {
  v.result("surface", c.last.request.before, "The terrain.");
  v.result("polygon", c.last.request.polygon, core::plain().only_if(!c.last.request.polygon.empty()), "What was counted within.");
  v.result("area", c.last.volumes.area, "Area compared.");
  v.result("area_left_out", c.last.volumes.area_left_out, "Area where the terrain is void.");
  v.result("impossible_heights", c.last.impossible_heights, core::if_any(), "Heights of the raster that no ground has, taken as void.");
  v.result("notes", c.last.notes, core::plain().only_if(!c.last.notes.empty()), "What was taken for granted.");
  v.tables("levels", c.rows, "Levels from the lowest up.");
}

/// "LOW,HIGH,STEP" as levels; HIGH is the last one, also where it is not a whole number of steps above LOW. Throws core::Error: not three
/// numbers, no step, HIGH not above LOW, more than 1000 levels.
std::vector<double> levels_of(const std::string& text);

/// All that is below a level counts, connected with the rest or not: state a polygon where hollows beyond the dam must not. Throws as
/// volumes_of().
LevelCurve level_curve(const VolumeRequest& request, const std::vector<double>& levels);
std::string level_text(const LevelCurve& curve);

}  // namespace swath::pipeline
