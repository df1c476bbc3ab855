// SPDX-License-Identifier: GPL-3.0-or-later
// Source: Brandalize, "Perfilamento a laser", the calibration flight over a flat roof. Deviations: displacements are taken along the axes
// of the body (exact for a banked aircraft), not of the flight; every pair of opposite lines is a reading; heading comes from any two
// parallel lines that have the target at different distances to the side, so that an offset between survey and trajectory cancels there,
// too. Sigmas: all readings are linear in the lines' displacements, whose full covariance is carried (edges, survey, trajectory,
// calibration values held). Lines that are flown soon after one another share the trajectory's error.
#include "calib/target/target_readings.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "calib/target/attitude_displacement.h"
#include "core/geo/frames.h"

namespace swath::calib {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

namespace {

constexpr double parallel = 0.94;          // |cosine| of two headings that count as parallel: within 20 deg
constexpr double same_height = 0.15;       // relative difference of heights within one reading
constexpr double too_vague = 0.5;          // m: a displacement of larger sigma is none
constexpr double two_heights_apart = 1.2;  // ratio
constexpr double profile_tangent = 0.01;   // of a line's widest beam over the target
constexpr double along_free = 1.0;         // m, a-priori sigma of lever arms where two heights separate them from angles
constexpr double datum_free = 10.0;        // m
constexpr double scale_free = 0.02;

using Index = Eigen::Index;
Index row_of(size_t line, int axis) { return 3 * static_cast<Index>(line) + axis; }

/// Of body axis k of line l, by the returns and the survey alone: is it a reading at all?
bool known(const TargetMeasures& m, size_t l, int axis) {
  const auto block = m.covariance.block<3, 3>(row_of(l, 0), row_of(l, 0));
  return block(axis, axis) < too_vague * too_vague;
}

double variance(const TargetMeasures& m, const RowVectorXd& by) {
  return (by * m.covariance * by.transpose()).value() + (by * m.held).squaredNorm();
}

void mean_of(const TargetMeasures& m, ReadingMean& r) {
  if (r.readings.empty()) return;
  double weights = 0.0;
  r.by = RowVectorXd::Zero(m.covariance.cols());
  std::set<int> lines;
  for (Reading& one : r.readings) {
    one.sigma = std::sqrt(variance(m, one.by));
    const double w = 1.0 / (one.sigma * one.sigma);
    weights += w;
    r.value += w * one.value;
    r.by += w * one.by;
    lines.insert(one.first);
    if (one.second >= 0) lines.insert(one.second);
  }
  r.value /= weights;
  r.by /= weights;
  r.own = r.sigma = std::sqrt(variance(m, r.by));
  r.determined = true;
  const bool single = r.readings.front().second < 0;
  const int apart = static_cast<int>(single ? lines.size() : lines.size() / 2);  // readings without a line in common
  if (apart < 2) return;
  double scatter = 0.0;
  for (const Reading& one : r.readings) scatter += std::pow((one.value - r.value) / one.sigma, 2) / weights;
  r.scatter = std::sqrt(scatter / (apart - 1));
  // The scatter of n readings is itself known to 1 / sqrt(2 (n - 1)) only: it counts beyond twice that.
  if (r.scatter * r.scatter > r.own * r.own * (1.0 + 2.0 * std::sqrt(2.0 / (apart - 1)))) r.sigma = r.scatter;
}

}  // namespace

std::string_view name_of(TargetRole r) {
  constexpr std::array<std::string_view, 4> names{"profile", "nadir", "between", "edge"};
  return names[static_cast<size_t>(r)];
}

namespace {

/// The view of a line from the pose: what does not need the other lines.
LineMeasure measure_of(int line, const TargetView& view, const trajectory::Pose& pose, const ShotGeometry& geometry,
                       const RoofTarget& target) {
  LineMeasure l;
  l.line = line;
  l.view = &view;
  l.heading = view.heading;
  l.body_R_local = (target.frame.local_R_ecef * pose.ecef_R_body).transpose();
  const Eigen::Vector2d x(std::sin(view.heading), std::cos(view.heading)), y(x.y(), -x.x());
  Matrix3d local_R_level = Matrix3d::Identity();
  local_R_level.block<2, 1>(0, 0) = x;
  local_R_level.block<2, 1>(0, 1) = y;
  l.body_R_level = l.body_R_local * local_R_level;
  const Vector3d scanner = target.frame.local_R_ecef * (pose.position + pose.ecef_R_body * geometry.lever_arm() - target.frame.origin);
  const Vector3d centre(view.centre.x(), view.centre.y(), target.up(view.centre));
  l.target = l.body_R_local * (centre - scanner);
  l.delta = l.body_R_level * Vector3d(view.displacement.x(), view.displacement.y(), view.height);
  Jacobian by;
  geometry.ecef_point(pose, view.middle, by);
  l.by = pose.ecef_R_body.transpose() * by;
  return l;
}

TargetRole role_of(const TargetView& view, const ShotGeometry& geometry, double widest, const RoleShares& shares) {
  if (widest < profile_tangent) return TargetRole::profile;
  const Vector3d beam = geometry.beam()(geometry.angle(view.middle.angle), view.middle.forward).direction;
  const double share = std::abs(beam.y() / beam.z()) / std::max(widest, 1e-6);
  if (share <= shares.nadir) return view.covariance(1, 1) > too_vague * too_vague ? TargetRole::profile : TargetRole::nadir;
  return share >= shares.edge ? TargetRole::edge : TargetRole::between;
}

/// Effect on a line's displacement of one sigma of the survey: 3 x 3n, east, north of each corner, then their heights.
MatrixXd survey_effect(const LineMeasure& l, const RoofTarget& target) {
  const Index corners = static_cast<Index>(target.sides());
  MatrixXd A(corners, 3);
  for (Index k = 0; k < corners; ++k)
    A.row(k) << 1.0, target.corners[static_cast<size_t>(k)].x(), target.corners[static_cast<size_t>(k)].y();
  const MatrixXd plane_by_heights = (A.transpose() * A).inverse() * A.transpose();
  MatrixXd survey = MatrixXd::Zero(3, 3 * corners);
  survey.leftCols(2 * corners) = target.sigma_h * l.body_R_level.leftCols<2>() * l.view->by_corners;
  const Eigen::RowVector3d at(1.0, l.view->centre.x(), l.view->centre.y());
  survey.rightCols(corners) = -target.sigma_v * l.body_R_level.col(2) * (at * plane_by_heights);
  return survey;
}

/// Effect of one sigma of each calibration value that no reading estimates.
MatrixXd held_effects(const std::vector<LineMeasure>& lines, const RoofTarget& target, const core::SensorSigma& sigma) {
  std::vector<std::pair<Parameter, double>> held{{lever_forward, sigma.lever_arm.value}, {lever_right, sigma.lever_arm.value},
                                                 {lever_down, sigma.lever_arm.value},    {range_scale, sigma.range_scale},
                                                 {scan_scale, sigma.scan_scale},         {latency, sigma.latency.value}};
  if (!target.surveyed) held.push_back({range_offset, sigma.range_offset.value});
  MatrixXd out = MatrixXd::Zero(3 * static_cast<Index>(lines.size()), static_cast<Index>(held.size()));
  for (size_t i = 0; i < lines.size(); ++i)
    for (size_t k = 0; k < held.size(); ++k)
      out.block<3, 1>(row_of(i, 0), static_cast<Index>(k)) = held[k].second * lines[i].by.col(held[k].first);
  return out;
}

}  // namespace

TargetMeasures target_measures(const std::vector<std::pair<int, const TargetView*>>& views, const ShotGeometry& geometry,
                               const trajectory::Trajectory& trajectory, const TrajectoryCovariance& trajectory_covariance,
                               const RoofTarget& target, const core::SensorSigma& sigma, double widest, const RoleShares& shares) {
  TargetMeasures m;
  m.widest = widest;
  m.surveyed = target.surveyed;
  m.across = geometry.beam().is_across() && !geometry.beam().ignores_record();
  std::vector<double> times;
  std::vector<MatrixXd> by_survey;
  for (const auto& [line, view] : views) {
    const double t = geometry.time(view->time);
    const auto pose = trajectory.pose_at(t);
    if (!view->seen || !pose) continue;
    m.lines.push_back(measure_of(line, *view, *pose, geometry, target));
    m.lines.back().role = role_of(*view, geometry, widest, shares);
    by_survey.push_back(survey_effect(m.lines.back(), target));
    times.push_back(t);
  }

  const size_t n = m.lines.size();
  m.covariance = MatrixXd::Zero(3 * static_cast<Index>(n), 3 * static_cast<Index>(n));
  if (n == 0) return m;
  const MatrixXd path = trajectory_covariance(times);
  for (size_t i = 0; i < n; ++i)
    for (size_t j = 0; j < n; ++j) {
      auto block = m.covariance.block<3, 3>(row_of(i, 0), row_of(j, 0));
      block += by_survey[i] * by_survey[j].transpose();
      block += m.lines[i].by.middleCols<6>(position_north) * path.block<6, 6>(6 * static_cast<Index>(i), 6 * static_cast<Index>(j)) *
               m.lines[j].by.middleCols<6>(position_north).transpose();
      if (i != j) continue;
      const TargetView& v = *m.lines[i].view;
      Matrix3d returns = Matrix3d::Zero();
      returns.topLeftCorner<2, 2>() = v.covariance;
      returns(2, 2) = v.height_sigma * v.height_sigma;
      block += m.lines[i].body_R_level * returns * m.lines[i].body_R_level.transpose();
    }
  m.held = held_effects(m.lines, target, sigma);
  for (size_t i = 0; i < n; ++i) {
    const Matrix3d all = m.covariance.block<3, 3>(row_of(i, 0), row_of(i, 0)) +
                         m.held.middleRows<3>(row_of(i, 0)) * m.held.middleRows<3>(row_of(i, 0)).transpose();
    m.lines[i].sigma = (m.lines[i].body_R_level.transpose() * all * m.lines[i].body_R_level).diagonal().cwiseSqrt();
  }
  return m;
}

namespace {

Reading reading_of(const TargetMeasures& m, size_t i, size_t j) {
  Reading r;
  r.first = m.lines[i].line;
  r.second = m.lines[j].line;
  r.by = RowVectorXd::Zero(3 * static_cast<Index>(m.lines.size()));
  return r;
}

double half_swath(const TargetMeasures& m, size_t i) { return m.widest * m.lines[i].target.z(); }

void read_pitch_and_roll(const TargetMeasures& m, AngleReadings& out) {
  for (size_t i = 0; i < m.lines.size(); ++i)
    for (size_t j = i + 1; j < m.lines.size(); ++j) {
      const LineMeasure &a = m.lines[i], &b = m.lines[j];
      if (std::cos(a.heading - b.heading) > -parallel) continue;
      const double z = 0.5 * (a.target.z() + b.target.z());
      if (std::abs(a.target.z() - b.target.z()) > same_height * z) continue;
      // Heading and the scan's scale act on a target to the side: opposite lines over the same ground are free of them.
      constexpr double same_ground = 0.35;  // of the swath's half width
      const bool profile = a.role == TargetRole::profile && b.role == TargetRole::profile;
      if (!profile && 0.5 * std::abs(a.target.y() + b.target.y()) > same_ground * half_swath(m, i)) continue;
      if (known(m, i, 0) && known(m, j, 0)) {
        Reading r = reading_of(m, i, j);
        r.value = pitch_displacement(0.5 * (a.delta.x() + b.delta.x()), z);  // eq 9
        r.by[row_of(i, 0)] = r.by[row_of(j, 0)] = 0.5 / z;
        out.pitch.readings.push_back(r);
      }
      if (!profile && known(m, i, 1) && known(m, j, 1)) {
        Reading r = reading_of(m, i, j);
        r.value = roll_displacement(0.5 * (a.delta.y() + b.delta.y()), z);  // eq 10
        r.by[row_of(i, 1)] = r.by[row_of(j, 1)] = -0.5 / z;
        out.roll.readings.push_back(r);
      }
    }
  mean_of(m, out.pitch);
  mean_of(m, out.roll);
}

void read_heading(const TargetMeasures& m, AngleReadings& out) {
  for (size_t i = 0; i < m.lines.size(); ++i)
    for (size_t j = i + 1; j < m.lines.size(); ++j) {
      const LineMeasure &a = m.lines[i], &b = m.lines[j];
      const double cosine = std::cos(a.heading - b.heading);
      if (std::abs(cosine) < parallel || !known(m, i, 0) || !known(m, j, 0)) continue;
      const double sense = cosine > 0.0 ? 1.0 : -1.0;
      // y as computed, with the roll error found before taken out.
      const auto y = [&](const LineMeasure& l) { return l.target.y() + l.delta.y() + l.target.z() * out.roll.value; };
      const double apart = y(a) - sense * y(b), z = a.target.z() - sense * b.target.z();
      constexpr double far_enough = 0.5;  // of the swath's half width
      if (std::abs(apart) < far_enough * std::max(half_swath(m, i), half_swath(m, j))) continue;
      if (sense < 0.0 && !out.pitch.determined) continue;
      Reading r = reading_of(m, i, j);
      r.value = heading_displacement(a.delta.x() - sense * b.delta.x(), z, out.pitch.value, apart);  // eq 11
      r.by[row_of(i, 0)] = -1.0 / apart;
      r.by[row_of(j, 0)] = sense / apart;
      if (out.pitch.determined) r.by += z / apart * out.pitch.by;
      out.heading.readings.push_back(r);
    }
  mean_of(m, out.heading);
}

/// Along the beam: turns of the scanner do not act there.
void read_range(const TargetMeasures& m, AngleReadings& out) {
  for (size_t i = 0; i < m.lines.size(); ++i) {
    const Vector3d u = m.lines[i].by.col(range_offset);
    if (!known(m, i, 2)) continue;
    Reading r = reading_of(m, i, i);
    r.second = -1;
    const bool plan = known(m, i, 0) && known(m, i, 1);
    // Without its place in plan, the height alone shows the error of the range.
    if (plan) {
      r.value = u.dot(m.lines[i].delta) / u.squaredNorm();
      r.by.segment<3>(row_of(i, 0)) = u.transpose() / u.squaredNorm();
    } else {
      r.value = m.lines[i].delta.z() / u.z();
      r.by[row_of(i, 2)] = 1.0 / u.z();
    }
    out.range.readings.push_back(r);
  }
  mean_of(m, out.range);
}

}  // namespace

AngleReadings read_angles(const TargetMeasures& given) {
  TargetMeasures m = given;
  // An offset between survey and trajectory cancels in pairs but for the difference of their headings: it is taken out beforehand.
  const JointTarget joint = solve_jointly(m, {});
  const double most = *std::max_element(joint.datum_sigma.data(), joint.datum_sigma.data() + 2) < too_vague ? 1.0 : 0.0;
  for (LineMeasure& l : m.lines) l.delta -= most * l.body_R_local * Vector3d(joint.datum.x(), joint.datum.y(), 0.0);

  AngleReadings out;
  read_pitch_and_roll(m, out);
  read_heading(m, out);
  if (m.surveyed) read_range(m, out);
  return out;
}

namespace {

namespace joint {
enum : int { roll, pitch, heading, forward, right, scale, range, east, north, count };
}

bool scans(const TargetMeasures& m) { return m.across && m.widest > profile_tangent; }

/// Displacements, and the roof's growth across where it shows the scan's scale: d = A x with covariance C.
struct JointSystem {
  MatrixXd A, C;
  VectorXd d;
};

JointSystem joint_system(const TargetMeasures& m) {
  using namespace joint;
  const size_t n = m.lines.size();
  const size_t strains = scans(m) && m.surveyed ? n : 0;
  const Index rows = 3 * static_cast<Index>(n) + static_cast<Index>(strains);
  MatrixXd A = MatrixXd::Zero(rows, count), C = MatrixXd::Zero(rows, rows);
  VectorXd d = VectorXd::Zero(rows);
  const Index last = 3 * static_cast<Index>(n);
  C.topLeftCorner(last, last) = m.covariance;
  // Values held, but for those that are free here (lever arms forward and right, the scan's scale: columns 0, 1 and 4).
  for (const Index k : {2, 3, 5, 6})
    if (k < m.held.cols()) C.topLeftCorner(last, last) += m.held.col(k) * m.held.col(k).transpose();
  VectorXd common = VectorXd::Zero(rows);  // growth of the roof at its edges: the same in all lines
  for (size_t i = 0; i < n; ++i) {
    const LineMeasure& l = m.lines[i];
    auto block = A.middleRows<3>(row_of(i, 0));
    for (int k = 0; k < 3; ++k) block.col(roll + k) = l.by.col(boresight_roll + k);
    block.col(forward) = l.by.col(lever_forward);
    block.col(right) = l.by.col(lever_right);
    block.col(scale) = l.by.col(scan_scale);
    block.col(range) = m.surveyed ? Vector3d(l.by.col(range_offset)) : Vector3d(l.body_R_local.col(2));
    block.col(east) = l.body_R_local.col(0);
    block.col(north) = l.body_R_local.col(1);
    d.segment<3>(row_of(i, 0)) = l.delta;
    if (strains == 0) continue;
    const Index row = last + static_cast<Index>(i);
    const double a = std::atan2(l.target.y(), l.target.z());
    A(row, scale) = 1.0 + 2.0 * a * std::tan(a);
    d[row] = l.view->strain_across;
    const double own = std::pow(l.view->strain_across_sigma, 2) - std::pow(l.view->strain_across_by_growth, 2);
    C(row, row) = std::max(own, 0.25 * std::pow(l.view->strain_across_sigma, 2));
    common[row] = l.view->strain_across_by_growth;
  }
  C += common * common.transpose();
  return {std::move(A), std::move(C), std::move(d)};
}

}  // namespace

JointTarget solve_jointly(const TargetMeasures& m, const core::SensorSigma& sigma) {
  JointTarget out;
  const size_t n = m.lines.size();
  if (n == 0) return out;
  out.lowest = 1e300;
  for (const LineMeasure& l : m.lines) {
    out.lowest = std::min(out.lowest, l.target.z());
    out.highest = std::max(out.highest, l.target.z());
  }
  out.two_heights = out.highest > two_heights_apart * out.lowest;

  using namespace joint;
  const bool scan = scans(m);
  const auto [A, C, d] = joint_system(m);
  const Index rows = d.size();
  const MatrixXd inverse = C.ldlt().solve(MatrixXd::Identity(rows, rows));
  MatrixXd N = A.transpose() * inverse * A;
  const auto prior = [&](int k, double s) { N(k, k) += 1.0 / (s * s); };
  constexpr double least = 1e-4;  // m
  const double arm = out.two_heights ? along_free : std::max(least, sigma.lever_arm.value);
  prior(forward, arm);
  prior(right, arm);
  prior(scale, scan ? scale_free : 1e-9);
  prior(east, datum_free);
  prior(north, datum_free);
  constexpr double angle_free = 0.1, range_free = 10.0;  // rad, m
  for (const int k : {roll, pitch, heading}) prior(k, angle_free);
  prior(range, range_free);
  const MatrixXd covariance = N.inverse();
  const VectorXd x = covariance * (A.transpose() * inverse * d);
  const VectorXd v = d - A * x;
  const double freedom = static_cast<double>(rows) - static_cast<double>(count) + 4.0;  // four of the priors decide
  out.chi2 = v.dot(inverse * v) / std::max(1.0, freedom);
  const auto one = [&](int k, bool free) { return JointTarget::One{free, x[k], std::sqrt(covariance(k, k))}; };
  constexpr double known_angle = 0.01;  // rad: sigma below which an angle is known at all
  for (const auto& [k, into] :
       {std::pair{int{roll}, &out.roll}, std::pair{int{pitch}, &out.pitch}, std::pair{int{heading}, &out.heading}}) {
    *into = one(k, true);
    into->free = into->sigma < known_angle;
  }
  out.lever_forward = one(forward, out.two_heights);
  out.lever_right = one(right, out.two_heights);
  out.scan_scale = one(scale, scan);
  if (m.surveyed) out.range_offset = one(range, true);
  out.datum = {x[east], x[north], m.surveyed ? 0.0 : x[range]};
  out.datum_sigma = {std::sqrt(covariance(east, east)), std::sqrt(covariance(north, north)),
                     m.surveyed ? 0.0 : std::sqrt(covariance(range, range))};
  return out;
}

}  // namespace swath::calib
