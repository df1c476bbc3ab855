// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/warnings.h"

#include <algorithm>

#include "core/error.h"

namespace swath::pipeline {

const std::vector<WarningKind>& warning_kinds() {
  static const std::vector<WarningKind> kinds{
      {"buildings.none", "No return is of class building (6): terrain.buildings has nothing to work on.",
       "Put filters.classify before it, or have a cloud whose buildings are of class 6; where nothing is built this is right."},
      {"calib.finding",
       "An adjustment found what its records do not determine or what contradicts them: a value, a flight line, a spread of corrections.",
       "The sentence ends with what to do; report.html of the adjustment shows the lines, residuals and sigmas."},
      {"check.cover", "Covers of check points are not known words: these points count as vegetated.",
       "Write open, bare, urban, grass, crops, brush or forest in the table, or name those without vegetation in quality.points.open."},
      {"check.few", "Fewer than three check points could be compared: no accuracy is stated by them.",
       "Survey more check points within the area; ASPRS 2024 wants 30 for a statement of accuracy."},
      {"check.heights",
       "The ground lies to one side of the check points on all lines, beyond four sigmas, or their heights are in feet beside metres.",
       "Compare geoid, height system, datum and antenna heights of check points and survey."},
      {"check.line", "One flight line differs from its check points beyond four sigmas, and other lines do not.",
       "Look at the line's trajectory (report, quality.geometry); calib.strips can adjust it."},
      {"check.mark", "One check point differs from the ground of all lines that show it, beyond four sigmas.",
       "Look at its record in the field book; it may be set on something that is no ground."},
      {"check.names", "Several check points have the same name: their records cannot be kept apart by it.",
       "Give each check point a name of its own; all of them are compared."},
      {"check.outside", "Check points lie outside the survey's points.",
       "Where all do, compare the CRS and the order of the columns of this [[control]] with the survey's."},
      {"check.roof",
       "A surveyed roof lies elsewhere than the others place it, its edges contradict one another, or they all lie farther out or in.",
       "Compare it with a newer picture: it may have been changed since, or surveyed wrongly; it counts in no figure."},
      {"clouds.duplicates", "More than 1 in 1000 first returns share place, time and return number with another: points are there twice.",
       "Look for tiles with buffers, or for a tile in two deliveries, and have them cut to their squares; density and spacing are without "
       "the copies."},
      {"clouds.same_file", "Two clouds of the run hold the same bytes under two names: their points are there twice.",
       "Name one of them, or take the copy out of the folder; density and every count of points are too large with it."},
      {"contours.interval", "Contours lie closer than the sigma of the terrain model supports, in any class of maps.",
       "State a larger interval: the sentence names those that the model carries. What lies below shows the noise of the model."},
      {"contours.short", "Every contour is shorter than contours.min_length or encloses less than contours.min_area: none is written.",
       "State them for the size of the area and the interval: --set contours.min_length=\"1 m\"."},
      {"control.unused", "A [[control]] of the survey is used by no stage of the run.",
       "Add a stage that uses it (quality.points for check points, calib.adjust for control), or leave it out of the survey."},
      {"crs.outside", "The data lie far outside the area of use of the products' CRS.",
       "Compare the CRS with the place: is it that of another zone or country? Clouds are transformed to the one named by --crs or the "
       "survey."},
      {"crs.scale", "Lengths on the map differ from those on the ground by more than 0.5 % at the data.",
       "Choose a local projection, such as the UTM zone, as CRS of the products, or correct areas, densities and volumes by the scale."},
      {"events.outside",
       "Nearly all events of a technique lie outside the trajectory, the GNSS fixes or the events they are compared with.",
       "Correct time scale, week, date or time.offset of that [[event]] in survey.toml; `swath info` shows the times of both files."},
      {"geometry.contradiction", "Lines, heights or headings of the flight contradict one another more than their accuracy allows.",
       "See the checks of quality.geometry in report.json, and the warnings geometry.mistake beside this one."},
      {"geometry.mistake", "A usual mistake in the description of the survey explains the contradictions.",
       "The sentence ends with what to change in survey.toml; run again and compare."},
      {"laser.outside_lines", "More than 20 % of the laser records lie outside all flight lines: they are left out.",
       "Compare start and end of the [[line]]s, and line_time, with the records' times: `swath info` of the file; turns that were scanned "
       "belong to no line, and this is right for them."},
      {"laser.outside_trajectory", "More than 1 % of the returns lie outside the trajectory, or in its gaps: they are left out.",
       "Compare the times of laser and trajectory with `swath info`; a trajectory that ends early or has gaps needs its missing records."},
      {"limit.contradictions", "quality.geometry has more warnings than run.limits.contradictions allows.",
       "Resolve the warnings of the geometry, or raise the limit."},
      {"limit.line_difference", "Lines differ on smooth ground by more than run.limits.line_difference.",
       "Check calibration and trajectory (quality.geometry, calib.adjust), or raise the limit."},
      {"limit.nva", "The RMSE at open check points is larger than run.limits.nva.",
       "See quality.points in report.json: bias, faults that are named; or raise the limit."},
      {"limit.outside", "More returns lie outside the trajectory than run.limits.outside allows.",
       "Compare the times of laser and trajectory with `swath info`, or raise the limit."},
      {"limit.overlap_difference", "Overlapping lines differ on smooth level ground by more than run.limits.overlap_difference.",
       "See the pairs of quality.swath and overlap_dz; calib.strips can adjust the lines; or raise the limit."},
      {"limit.planimetry", "The horizontal RMSE of roofs is larger than run.limits.planimetry.",
       "See planimetry and roofs of quality.points in report.json: a mean shift, roofs that differ; or raise the limit."},
      {"limit.quality_level", "More requirements of the quality level are missed than run.limits.quality_level allows.",
       "See the requirements of report.quality in report.json or quality.html."},
      {"limit.surface_difference", "Terrain model and reference differ by more than run.limits.surface_difference.",
       "See quality.surface in report.json by slope and cover, and the map of differences; or raise the limit."},
      {"limit.truth_rms", "Points are farther from the truth than run.limits.truth_rms.",
       "See report.truth in report.json, or raise the limit."},
      {"limit.void_share", "Voids without first returns take a larger share of the survey than run.limits.void_share.",
       "See the layer voids of swath.gpkg: fly the gaps again, classify water, or raise the limit."},
      {"limit.voids", "The terrain model has more holes than run.limits.voids allows.",
       "See the reasons of the voids in the quality raster, take larger cells, or raise the limit."},
      {"limit.vva", "The RMSE at vegetated check points is larger than run.limits.vva.",
       "See quality.points in report.json by cover; or raise the limit."},
      {"points.outside_box", "Points lie well outside the box that their file's header states.",
       "The points are used as they are; have the file written again, for other programs trust the box."},
      {"powerlines.none", "No span of a power line was found among the returns of class wire (14): there is no clearance.",
       "Lower filters.classify.wire_height where wires hang lower above the ground, and terrain.powerlines.min_span for short spans; where "
       "there is no line this is right."},
      {"run.memory", "A stage that holds a whole flight is estimated to need more memory than the default of run.memory leaves.",
       "State what the run may take, such as run.memory = \"4 GB\": any value but the default is enforced, and what does not fit is "
       "refused."},
      {"surface.undeclared", "The reference of quality.surface holds heights that no ground has, such as -9999: they are taken as void.",
       "Declare the value in the file: gdal_edit.py -a_nodata -9999 FILE. Where the sentence names a range, look at the unit of its "
       "heights."},
      {"trajectory.clocks", "The clocks of IMU and GNSS records differ by more than 2 ms and four sigmas.",
       "State the offset that the warning names in survey.toml: as it is, positions are off along the track by speed times offset."},
      {"trajectory.fixes", "Many GNSS fixes contradict the smoothed trajectory; the stated sigmas do not hold.",
       "See trajectory.json and what the readers counted: damaged records, clocks apart, a wrong lever arm, fixes of poor quality."},
      {"trajectory.gnss_sigmas",
       "The GNSS fixes scatter far less than their stated sigmas say; printed sigmas of the trajectory are too large.",
       "See how the receiver or the post-processing scales its sigmas. They are right where the errors change far more slowly than "
       "trajectory.ins_gnss.correlation_time: state that, or correlated_share."},
      {"trajectory.imu_noise", "The IMU's records hold many times the noise that its specification states.",
       "See what readers.imu counted in report.json: damaged records, wrong units or axes, strong vibration; correct imu_spec if the IMU "
       "is so."},
      {"trajectory.fix_step", "From one fix on all GNSS fixes are shifted by more than the IMU and their own scatter allow.",
       "Process the fixes again: another base station or frame, a wrong ambiguity, another antenna. The records do not show which of two "
       "levels is right; sigmas allow for both, but with correlated_share = 0."},
      {"trajectory.heading", "The heading is known to 0.2 deg or worse, and points beside the track with it.",
       "Turns, or changes of speed, before and after the lines show the heading to an IMU; where another source knows it, state "
       "trajectory.ins_gnss.alignment = \"given\" with its sigma, or use the processed trajectory."},
      {"trajectory.lever_arm", "The records show another lever arm of the antenna than the survey states.",
       "Measure it again: forward, right, down from the IMU's centre; a turned IMU, a wrong sign or clocks apart look like it, too."},
      {"trajectory.motion", "The attitude does not follow the flight: heading against track, roll and pitch against the turns.",
       "Correct axes, or the mounting roll, pitch and heading, of [[imu]]; a craft that flies sideways may be flagged without a fault."},
      {"work.damaged", "Pieces of an earlier run's work were changed or damaged, and were done again.",
       "Look for what writes into the work folder, and check the disk."},
  };
  return kinds;
}

std::string warning_help(const std::string& code) {
  std::string out;
  std::vector<std::string> codes;
  size_t width = 0;
  for (const WarningKind& k : warning_kinds()) width = std::max(width, k.code.size() + 1);
  for (const WarningKind& k : warning_kinds()) {
    codes.emplace_back(k.code);
    if (code.empty()) out += std::string(k.code) + std::string(width - k.code.size(), ' ') + std::string(k.meaning) + "\n";
    if (code == k.code) out = code + ": " + std::string(k.meaning) + "\n\n" + std::string(k.remedy) + "\n";
  }
  if (!out.empty()) return out;
  const std::string near = core::nearest(code, codes);
  throw core::usage_error("'" + code + "' is not a code of a warning", "",
                          near.empty() ? "`swath warnings` lists them" : "did you mean '" + near + "'?");
}

std::string warning_page() {
  std::string out = "| code | meaning | what to do |\n|---|---|---|\n";
  for (const WarningKind& k : warning_kinds())
    out += "| `" + std::string(k.code) + "` | " + std::string(k.meaning) + " | " + std::string(k.remedy) + " |\n";
  return out;
}

}  // namespace swath::pipeline
