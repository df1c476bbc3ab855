// SPDX-License-Identifier: GPL-3.0-or-later
// What block.json holds, and what the report is made of.
#pragma once

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "calib/block/block_adjust.h"
#include "calib/block/block_reading.h"
#include "calib/block/checks/unfit_points.h"
#include "calib/block/navigation/direct_comparison.h"
#include "core/config/result.h"

namespace swath::calib {

inline constexpr core::Form micrometres{"um", 2};

/// A value of a camera: f, x0, ... in their own units; boresight in deg, antenna in m.
struct CameraValueFound {
  std::string name, unit;
  double value = 0.0, sigma = 0.0;
  bool held = true;
};
template <class V>
void describe(const CameraValueFound& r, V& v) {
  v.result("name", r.name, "Value.");
  v.result("value", r.value, "Adjusted or held value.");
  v.result("unit", r.unit, "Its unit.");
  v.result("held", r.held, "True: it was not adjusted.");
  v.result("sigma", r.sigma, core::plain().only_if(!r.held), "Its standard deviation.");
  v.result("significant", std::abs(r.value) > 3.0 * r.sigma, core::plain().only_if(!r.held), "False: below three standard deviations.");
}

struct CameraFound {
  std::string name;
  std::vector<CameraValueFound> values;
  std::vector<std::string> correlated;  ///< names of what was adjusted
  Eigen::MatrixXd correlation;
};
template <class V>
void describe(const CameraFound& r, V& v) {
  v.result("name", r.name, "Name.");
  v.tables("values", r.values, "Values.");
  v.result("correlated", r.correlated, core::plain().only_if(!r.correlated.empty()), "Names of the rows of `correlation`.");
  v.result("correlation", r.correlation, core::plain().only_if(!r.correlated.empty()), "Correlation of the adjusted values.");
}

/// Shift and drift of the stations of a set.
struct SetDriftFound {
  int strip = 0;
  bool of_strip = false;
  Eigen::Vector3d shift, shift_sigma, change, change_sigma;
  double span = 0.0;
};
template <class V>
void describe(const SetDriftFound& r, V& v) {
  v.result("strip", r.strip, core::plain().only_if(r.of_strip), "Strip.");
  v.result("shift_m", r.shift, core::metres(), "Shift at the first station: east, north, up.");
  v.result("shift_sigma_m", r.shift_sigma, core::metres(), "Its standard deviations.");
  v.result("change_m", r.change, core::metres(), "Change to the last station.");
  v.result("change_sigma_m", r.change_sigma, core::metres(), "Its standard deviations.");
  v.result("span_s", r.span, core::seconds(1), "Time from the first station to the last.");
}

/// Datum of the stations against control (StationDatum).
struct DatumFound {
  bool similarity = false;
  Eigen::Vector3d shift, shift_sigma;        ///< m, axes of the local frame
  Eigen::Vector3d rotation, rotation_sigma;  ///< rad
  double scale = 0.0, scale_sigma = 0.0;     ///< less 1
};
template <class V>
void describe(const DatumFound& r, V& v) {
  constexpr double in_ppm = 1e6;
  const core::Form angle = core::in_degrees(7).only_if(r.similarity), ppm = core::Form{"ppm", 3}.only_if(r.similarity);
  v.result("shift_m", r.shift, core::metres(4), "Shift in the middle of the stations, stations less control: east, north, up.");
  v.result("shift_sigma_m", r.shift_sigma, core::metres(4), "Its standard deviations.");
  v.result("rotation_deg", Eigen::Vector3d(r.rotation / core::degree), angle, "Rotation about east, north and up, of control to stations.");
  v.result("rotation_sigma_deg", Eigen::Vector3d(r.rotation_sigma / core::degree), angle, "Its standard deviations.");
  v.result("scale_ppm", in_ppm * r.scale, ppm, "Scale of the stations against control, less 1.");
  v.result("scale_sigma_ppm", in_ppm * r.scale_sigma, ppm, "Its standard deviation.");
}

/// Differences of points, adjusted less surveyed.
struct PointDifference {
  std::string name;
  bool check = false;
  Eigen::Vector3d difference = Eigen::Vector3d::Zero(), sigma = Eigen::Vector3d::Zero();  ///< east, north, up of the grid
  std::array<bool, 3> known{true, true, true};
};
template <class V>
void describe(const PointDifference& r, V& v) {
  v.result("name", r.name, "Name.");
  v.result("check", r.check, "True: it took no part.");
  v.result("east_m", r.difference.x(), core::metres(4).only_if(r.known[0]), "Adjusted less surveyed, east.");
  v.result("north_m", r.difference.y(), core::metres(4).only_if(r.known[1]), "North.");
  v.result("up_m", r.difference.z(), core::metres(4).only_if(r.known[2]), "Up.");
  v.result("sigma_m", r.sigma, core::metres(4), "Standard deviations of the adjusted point: east, north, up.");
}

/// One coordinate of the check points.
struct CheckFound {
  std::string coordinate;
  size_t points = 0;
  double mean = 0.0, sd = 0.0, rms = 0.0, gsd = 0.0, over_sigma = 0.0;
};
template <class V>
void describe(const CheckFound& r, V& v) {
  v.result("coordinate", r.coordinate, "east, north or up.");
  v.result("points", r.points, "Check points.");
  v.result("mean_m", r.mean, core::metres(4), "Mean difference, adjusted less surveyed.");
  v.result("sd_m", r.sd, core::metres(4).only_if(r.points > 1), "Standard deviation about the mean.");
  v.result("rms_m", r.rms, core::metres(4), "Root mean square.");
  v.result("rms_gsd", r.rms / r.gsd, core::plain(2).only_if(r.gsd > 0.0), "The same in ground sample distances.");
  v.result("over_sigma", r.over_sigma, core::plain(2), "Root mean square of the differences over their own standard deviations.");
}

/// An observation with its residual.
struct SuspectFound {
  std::string what;
  double w = 0.0, residual = 0.0, redundancy = 0.0;
  std::string unit;
};
template <class V>
void describe(const SuspectFound& r, V& v) {
  v.result("what", r.what, "Observation.");
  v.result("w", r.w, core::plain(2), "Residual over its own standard deviation.");
  v.result("residual", r.residual, core::plain(4), "Residual, computed less observed.");
  v.result("unit", r.unit, "Its unit.");
  v.result("redundancy", r.redundancy, core::plain(3), "Share of an error that the residual shows.");
}

struct FactorFound {
  std::string kind;
  double factor = 1.0, redundancy = 0.0;
  bool estimated = false;
};
template <class V>
void describe(const FactorFound& r, V& v) {
  v.result("kind", r.kind, "Observations.");
  v.result("factor", r.factor, core::plain(3), "Factor on the stated sigmas.");
  v.result("estimated", r.estimated, "False: too few redundant observations, the stated sigmas are kept.");
  v.result("redundancy", r.redundancy, core::plain(1), "Sum of redundancies.");
}

struct BlockFound {
  UnfitPoints unfit;
  std::string started_from;
  size_t images = 0, points = 0, rays = 0, stations = 0, attitudes = 0, control = 0, checks = 0, points_left_out = 0, without_weight = 0;
  size_t observations = 0, unknowns = 0, iterations = 0, rounds = 0;
  double redundancy = 0.0, sigma0 = 1.0;
  double image_rms = 0.0;                                                                   ///< um
  double start_tie = 0.0, start_control = 0.0;                                              ///< mm
  double gsd = 0.0;                                                                         ///< m, 0: no pixels
  double plan = 0.0, height = 0.0, max_plan = 0.0, max_height = 0.0;                        ///< m, sigmas of points
  double station_sigma = 0.0, angle_sigma = 0.0;                                            ///< m, deg: rms over images
  double ray_redundancy = 0.0, inner = 0.0, max_inner = 0.0, outer = 0.0, max_outer = 0.0;  ///< um, m
  double smallest_pivot = 1.0;
  size_t rejected = 0;  ///< observations whose w is beyond the limit
  std::vector<FactorFound> factors;
  std::vector<CameraFound> cameras;
  std::vector<SetDriftFound> drifts;
  std::optional<DatumFound> datum;
  std::vector<DirectCompared> direct;  ///< of a run
  std::vector<CheckFound> check;
  std::vector<PointDifference> differences;
  std::vector<SuspectFound> suspects;
  std::vector<std::string> findings, control_without_image, images_without_points, parallel_points;
};

template <class V>
void describe(const BlockFound& r, V& v) {
  v.result("started_from", r.started_from, "What the start values were made of.");
  v.result("images", r.images, core::plain().in_summary(), "Images.");
  v.result("points", r.points, core::plain().in_summary(), "Points that take part.");
  v.result("image_points", r.rays, core::plain().in_summary(), "Image points.");
  v.result("stations", r.stations, "Observed stations.");
  v.result("attitudes", r.attitudes, "Observed attitudes.");
  v.result("control", r.control, "Control points.");
  v.result("check_points", r.checks, "Check points.");
  v.result("points_left_out", r.points_left_out, "Points with too few image points, or parallel rays.");
  v.result("without_weight", r.without_weight, "Image points whose weight fell to nothing.");
  v.result("observations", r.observations, "Observation equations.");
  v.result("unknowns", r.unknowns, "Unknowns.");
  v.result("redundancy", r.redundancy, core::plain(0), "Observations less unknowns.");
  v.result("sigma0", r.sigma0, core::plain(3), "Root of the variance factor with the factors below: 1 where sigmas and residuals agree.");
  v.result("image_residual_um", r.image_rms, micrometres, "Root mean square of the residuals of image coordinates that have weight.");
  v.result("start_residual_tie_mm", r.start_tie, core::millimetres(3), "Median residual of tie points at the start values.");
  v.result("start_residual_control_mm", r.start_control, core::millimetres(3), "The same of control points.");
  v.result("gsd_m", r.gsd, core::metres(4).only_if(r.gsd > 0.0), "Ground sample distance.");
  v.result("sigma_plan_m", r.plan, core::metres(4), "Standard deviation in plan: root of the mean variance of x and y of all points.");
  v.result("sigma_height_m", r.height, core::metres(4), "The same of heights.");
  v.result("max_sigma_plan_m", r.max_plan, core::metres(4), "Of the worst point.");
  v.result("max_sigma_height_m", r.max_height, core::metres(4), "Of the worst point.");
  v.result("sigma_position_m", r.station_sigma, core::metres(4), "Standard deviation of a coordinate of the perspective centres.");
  v.result("sigma_angle_deg", r.angle_sigma, core::in_degrees(5), "Standard deviation of an angle of the images.");
  v.result("ray_redundancy", r.ray_redundancy, core::plain(3), "Mean redundancy of an image coordinate.");
  v.result("inner_reliability_um", r.inner, micrometres, "Median of the smallest errors of image coordinates that the test finds.");
  v.result("max_inner_reliability_um", r.max_inner, micrometres, "The largest of them (redundancy above 0.05).");
  v.result("outer_reliability_m", r.outer, core::metres(4), "Median of what such an error moves its point.");
  v.result("max_outer_reliability_m", r.max_outer, core::metres(4), "The largest.");
  v.result("smallest_pivot", r.smallest_pivot, core::plain(),
           "Of the scaled normal equations: near 0 where the block is hardly determined.");
  v.result("rejected", r.rejected, "Observations whose |w| is above 3.29.");
  v.tables("factors", r.factors, "Factors on the sigmas by kind of observation.");
  v.tables("cameras", r.cameras, "Cameras.");
  v.tables("drifts", r.drifts, "Shift and drift of the stations.");
  v.table("datum", r.datum, "Datum of the stations against control.");
  v.tables_if(!r.direct.empty(), "direct", r.direct, "Direct orientation beside the integrated one, in a run.");
  v.tables("check", r.check, "Check points by coordinate.");
  v.tables("differences", r.differences, "Control and check points.");
  v.tables("suspects", r.suspects, "Observations with the largest |w|.");
  v.result("findings", r.findings, core::plain().in_summary(), "What to look at, as sentences.");
  v.result("control_without_image", r.control_without_image, core::plain().only_if(!r.control_without_image.empty()),
           "Control points that no image shows.");
  v.result("parallel_points", r.parallel_points, core::plain().only_if(!r.parallel_points.empty()),
           "Points left out because their rays are parallel.");
  v.result("images_without_points", r.images_without_points, core::plain().only_if(!r.images_without_points.empty()),
           "Images that have observed angles alone.");
}

/// Of an adjusted block.
BlockFound findings_of(const ReadBlock& read, const BlockConfig& config, const BlockSolution& solution);

/// For a terminal.
std::string block_text(const BlockFound& found);

}  // namespace swath::calib
