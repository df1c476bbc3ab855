// SPDX-License-Identifier: GPL-3.0-or-later
// What lever_arm.json and the report hold of a hangar survey.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calib/hangar/hangar.h"
#include "core/config/result.h"
#include "core/config/units.h"

namespace swath::calib {

inline Eigen::VectorXd sigmas_of(const Eigen::MatrixXd& covariance) { return covariance.diagonal().cwiseMax(0).cwiseSqrt(); }

/// A second position that the observations allow.
struct MirrorPosition {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  double variance_factor = 0.0;
};

template <class V>
void describe(const MirrorPosition& r, V& v) {
  v.result("position_m", r.position, core::metres(4), "The second position.");
  v.result("variance_factor", r.variance_factor, core::plain(2).always(), "Its variance factor.");
}

struct DistanceResidual {
  std::string to;
  double residual = 0.0, w = 0.0;
};

template <class V>
void describe(const DistanceResidual& r, V& v) {
  v.result("to", r.to, "Target of the distance.");
  v.result("residual_mm", -1e3 * r.residual, core::millimetres().always(), "Adjusted less observed distance.");
  v.result("w", 0.0 - r.w, core::plain(2).always(), "Residual divided by its own sigma; 0 where nothing checks the distance.");
}

template <class V>
void describe(const StationResult& r, V& v) {
  const Resection& x = r.resection;
  const bool found = !r.stated;
  std::optional<MirrorPosition> mirror;
  if (found && x.mirror) mirror = MirrorPosition{*x.mirror, x.mirror_variance_factor};
  std::vector<DistanceResidual> distances;
  for (size_t i = 0; found && i < r.targets.size(); ++i) distances.push_back({r.targets[i], x.residual[i], x.w[i]});
  v.result("name", r.name, "Name of the station.");
  v.result("from", std::string(r.stated ? "stated coordinates" : "distances"), "What gave its position.");
  v.result("position_m", r.position, core::metres(4), "Position.");
  v.result("sigma_m", sigmas_of(r.covariance), core::metres(4), "Standard deviations of the position.");
  v.result("redundancy", x.redundancy, core::plain().only_if(found), "Number of distances less three.");
  v.result("variance_factor", x.variance_factor, core::plain(2).only_if(found && x.redundancy > 0).always(),
           "A posteriori variance factor of the distances.");
  v.result("covariance_multiplied_by", r.factor, core::plain(2).only_if(found),
           "Factor on the covariance where distances scatter too much.");
  v.table("mirror", mirror, "A second position that the distances lead to.");
  v.tables_if(found, "distances", distances, "Distances to its targets.");
}

template <class V>
void describe(const PointResult& r, V& v) {
  std::optional<MirrorPosition> mirror;
  if (r.search.mirror) mirror = MirrorPosition{*r.search.mirror, r.search.mirror_variance_factor};
  v.result("name", r.name, "Name of the point.");
  v.result("role", r.role, "What it is.");
  v.result("from", std::string(r.stated ? "stated coordinates" : "sights"), "What gave its position.");
  v.result("position_m", r.position, core::metres(4), "Position.");
  v.result("sigma_m", sigmas_of(r.covariance), core::metres(4), "Standard deviations of the position.");
  v.table("mirror", mirror, "A second position that the sights allow.");
}

template <class V>
void describe(const SightResult& r, V& v) {
  v.result("what", r.text, "The observation.");
  v.result("place", r.place, "File and line that it was read from.");
  v.result("observed", r.observed, core::plain().always(), "As observed, in rad (angles) or m (distances).");
  v.result("residual", r.residual, core::plain().always(), "Adjusted less observed, in rad (angles) or m (distances).");
  v.result("sigma", r.sigma, core::plain().always(), "Its standard deviation, in rad (angles) or m (distances).");
  v.result("w", r.w, core::plain(2).always(), "Residual divided by its own sigma.");
}

template <class V>
void describe(const LeverArm& r, V& v) {
  v.result("from", r.from, "Where the lever arm begins.");
  v.result("to", r.to, "Where it ends.");
  v.result("forward_right_down_m", r.value, core::metres(4).in_summary(), "The lever arm in body axes.");
  v.result("sigma_m", sigmas_of(r.covariance), core::metres(4).in_summary(), "Its standard deviations.");
  v.result("covariance_m2", r.covariance, core::Form{"m2"}, "Its covariance.");
}

/// How the body's axes lie in the hangar.
struct AxesResult {
  BodyAxes axes{};
  double heading_sigma = 0.0;
};

template <class V>
void describe(const AxesResult& r, V& v) {
  const core::Form angle = core::in_degrees(4).always();
  v.result("roll_deg", core::to_degrees(r.axes.attitude.roll), angle, "Roll of the body.");
  v.result("pitch_deg", core::to_degrees(r.axes.attitude.pitch), angle, "Pitch of the body.");
  v.result("heading_deg", core::to_degrees(r.axes.attitude.heading), angle, "Heading of the body.");
  v.result("sigma_roll_deg", core::to_degrees(r.axes.sigma.x()), angle, "Standard deviation of the roll.");
  v.result("sigma_pitch_deg", core::to_degrees(r.axes.sigma.y()), angle, "Standard deviation of the pitch.");
  v.result("sigma_heading_deg", core::to_degrees(r.heading_sigma), angle, "Standard deviation of the heading.");
}

struct PointAdjustment {
  int redundancy = 0, iterations = 0;
  double variance_factor = 0.0, factor = 1.0;
};

template <class V>
void describe(const PointAdjustment& r, V& v) {
  v.result("redundancy", r.redundancy, "Observations less unknowns.");
  v.result("variance_factor", r.variance_factor, core::plain(2).only_if(r.redundancy > 0).always(), "A posteriori variance factor.");
  v.result("covariance_multiplied_by", r.factor, core::plain(2).always(), "Factor on the covariance where sights scatter too much.");
  v.result("iterations", r.iterations, "Iterations.");
}

template <class V>
void describe(const HangarResult& r, V& v) {
  std::optional<PointAdjustment> adjustment;
  if (r.adjusted) adjustment = PointAdjustment{r.adjusted->redundancy, r.adjusted->iterations, r.adjusted->variance_factor, r.point_factor};
  v.tables("lever_arms", r.lever_arms, "Lever arms that the survey needs.");
  v.result("survey_toml", r.lever_arms.empty() ? std::string() : survey_lines(r), core::plain().in_summary(), "The lines for survey.toml.");
  v.table("axes", AxesResult{r.axes, r.heading_sigma}, "Attitude of the body in the hangar.");
  v.tables("points", r.points, "Points of the aircraft.");
  v.table("adjustment", adjustment, "Adjustment of the points that were sighted.");
  v.tables("stations", r.stations, "Stations of the instrument.");
  v.tables("sights", r.sights, "Angles and distances to the points.");
  v.result("warnings", r.warnings, core::plain().in_summary(), "What looks wrong.");
}

}  // namespace swath::calib
