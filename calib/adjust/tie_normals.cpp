// SPDX-License-Identifier: GPL-3.0-or-later
// Sources: the condition that returns of all lines lie on common planes, with ranges and angles as observations (Gauss-Helmert): Skaloud
// & Lichti, "Rigorous approach to bore-sight self-calibration in airborne laser scanning", ISPRS Journal 61 (2006) 47; corrections of the
// trajectory by time: Glira et al. (2016). Deviations: the nadir's turn by a correction of the position is left out (0.1 m: 1.6e-8 rad,
// 0.01 mm at 700 m); corrections do not enter the derivative by the latency (their rates, under 1 mm/s against the carrier's speed).
#include "calib/adjust/tie_normals.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <thread>

#include "core/geo/frames.h"
#include "core/statistics.h"

namespace swath::calib {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double least_scale = 0.05;  // of the stated sigmas: exact records would leave nothing to divide by

// A point this share of its range off its plane is brought no nearer: it is an outlier, or the start is far.
constexpr double most_correction = 0.01;

// "Add it to the trajectory": metres in north, east, down, and Euler angles.
void correct(trajectory::Pose& pose, const Correction& d) {
  const Matrix3d ned = ecef_R_ned_at(pose);
  pose.position += ned * d.head<3>();
  core::Attitude a = core::attitude_of(ned.transpose() * pose.ecef_R_body);
  a.roll += d[3], a.pitch += d[4], a.heading += d[5];
  pose.ecef_R_body = ned * core::matrix_of(a);
}

// The unknowns that a group touches: all global ones, and the knots from its first to its last instant.
std::vector<int> unknowns_of(const TieProblem& p, const TieGroup& g, double latency) {
  const std::vector<double>& t = p.ties->returns.time;
  const auto [first, last] = std::minmax_element(t.begin() + g.begin, t.begin() + g.end);
  const int globals = static_cast<int>(p.globals.size());
  std::vector<int> out(globals);
  for (int i = 0; i < globals; ++i) out[i] = i;
  const auto add = [&](const CorrectionKnots::Weights& from, const CorrectionKnots::Weights& to) {
    if (from.count == 0) return;
    for (int k = from.first[0]; k < to.first[to.count - 1] + 3; ++k) out.push_back(globals + k);
  };
  add(p.knots->position(g.line, *first + latency), p.knots->position(g.line, *last + latency));
  add(p.knots->attitude(g.line, *first + latency), p.knots->attitude(g.line, *last + latency));
  return out;
}

// Where the threes of the knots lie in a group's unknowns.
struct Places {
  int position = 0, attitude = 0;              // place of the first
  int first_position = 0, first_attitude = 0;  // its number among the knots
};
Places places_of(const TieProblem& p, const std::vector<int>& index) {
  const int globals = static_cast<int>(p.globals.size());
  Places out;
  out.position = globals;
  int i = globals;
  const int n = static_cast<int>(index.size());
  if (i < n && p.knots->is_position(index[i] - globals)) out.first_position = index[i] - globals;
  while (i < n && p.knots->is_position(index[i] - globals)) ++i;
  out.attitude = i;
  if (i < n) out.first_attitude = index[i] - globals;
  return out;
}

// Rows of observations that are summed in packs.
constexpr int pack = 64;

struct Workspace {
  std::vector<Condition> conditions;
  std::vector<double> sorted;
  Eigen::MatrixXd rows;  // unknowns x pack
};

/// Sums a group's normal equations, observation by observation: unknowns, the plane's three, and the right side last.
class RowPack {
 public:
  RowPack(const TieProblem& p, std::uint32_t line, const Places& places, int unknowns, Eigen::MatrixXd& rows)
      : p_(p), line_(line), places_(places), rows_(rows), sum_(Eigen::MatrixXd::Zero(unknowns + 4, unknowns + 4)) {
    rows_.setZero(unknowns + 4, pack);
  }
  void add(const Condition& c, double t, double root) {
    auto row = rows_.col(filled_);
    const auto globals = static_cast<int>(p_.globals.size());
    for (int k = 0; k < globals; ++k) row[k] = root * c.by[p_.globals[k]];
    const CorrectionKnots::Weights wp = p_.knots->position(line_, t), wa = p_.knots->attitude(line_, t);
    for (int k = 0; k < wp.count; ++k)
      row.segment<3>(places_.position + wp.first[k] - places_.first_position) = (root * wp.weight[k]) * c.by.segment<3>(position_north);
    for (int k = 0; k < wa.count; ++k)
      row.segment<3>(places_.attitude + wa.first[k] - places_.first_attitude) = (root * wa.weight[k]) * c.by.segment<3>(attitude_roll);
    row.tail<4>() << -root, -root * c.u, -root * c.v, root * c.f;
    if (++filled_ == pack) flush();
  }
  Eigen::MatrixXd finish() {
    flush();
    sum_.triangularView<Eigen::StrictlyUpper>() = sum_.transpose();
    return std::move(sum_);
  }

 private:
  void flush() {
    if (filled_ > 0) sum_.selfadjointView<Eigen::Lower>().rankUpdate(rows_.leftCols(filled_));
    rows_.leftCols(filled_).setZero();
    filled_ = 0;
  }
  const TieProblem& p_;
  std::uint32_t line_;
  Places places_;
  Eigen::MatrixXd& rows_;
  Eigen::MatrixXd sum_;
  int filled_ = 0;
};

/// Distances of a group's returns, and their median: a tree or a car in the group does not move it, the state's own errors move all alike.
double condition_group(const TieProblem& p, const TieState& state, const ShotGeometry& geometry, const TieNoise& noise, const TieGroup& g,
                       trajectory::Cursor& cursor, Workspace& w) {
  w.conditions.resize(g.end - g.begin);
  w.sorted.clear();
  for (std::uint32_t i = g.begin; i < g.end; ++i) {
    Condition& c = w.conditions[i - g.begin];
    if (condition_of(p, geometry, state, noise, cursor, g, i, c))
      w.sorted.push_back(c.f);
    else
      c.f = std::numeric_limits<double>::quiet_NaN();
  }
  return w.sorted.empty() ? 0.0 : core::median(w.sorted);
}

void linearise_group(const TieProblem& p, const TieState& state, const ShotGeometry& geometry, const TieNoise& noise, double scale,
                     size_t number, trajectory::Cursor& cursor, Workspace& w, TiePass& pass) {
  const TieGroup& g = p.ties->groups[number];
  const TieReturns& returns = p.ties->returns;
  GroupBlock& block = pass.blocks[number];
  block.index = unknowns_of(p, g, state.calibration.latency.value);
  const int m = static_cast<int>(block.index.size());
  const double median = condition_group(p, state, geometry, noise, g, cursor, w);

  RowPack rows(p, g.line, places_of(p, block.index), m, w.rows);
  double mean = 0.0, weights = 0.0;
  for (std::uint32_t i = g.begin; i < g.end; ++i) {
    const Condition& c = w.conditions[i - g.begin];
    if (!std::isfinite(c.f)) {
      pass.deviation[i] = std::numeric_limits<float>::quiet_NaN();
      ++block.outside;
      continue;
    }
    const double sigma = std::sqrt(c.variance());
    const double z = (c.f - median) / sigma;
    pass.deviation[i] = static_cast<float>(z);
    const double share = p.robust(z / scale);
    if (share <= 0.0) {
      ++block.rejected;
      continue;
    }
    const double root = std::sqrt(share) / sigma, t = geometry.time(returns.time[i]);
    rows.add(c, t, root);
    ++block.used;
    block.angle += geometry.angle(returns.angle[i]);
    block.range += geometry.range(returns.range[i]);
    block.time += t;
    block.depth += c.depth;
    block.noise += c.range + c.angle;
    mean += root * root * c.f;
    weights += root * root;
  }
  const Eigen::MatrixXd sum = rows.finish();
  block.N = sum.topLeftCorner(m + 3, m + 3);
  block.b = sum.col(m + 3).head(m + 3);
  block.c = sum(m + 3, m + 3);
  if (block.used == 0) return;
  for (double* v : {&block.angle, &block.range, &block.time, &block.depth, &block.noise}) *v /= block.used;
  if (block.used >= 3) add_moments(p.robust, w.conditions, pass.deviation.data() + g.begin, scale, mean / weights, block);
}

}  // namespace

double value_of(const core::Calibration& c, Parameter p) {
  switch (p) {
    case boresight_roll:
      return c.roll.value;
    case boresight_pitch:
      return c.pitch.value;
    case boresight_heading:
      return c.heading.value;
    case lever_forward:
    case lever_right:
    case lever_down:
      return c.lever_arm_scanner[static_cast<size_t>(p - lever_forward)].value;
    case range_offset:
      return c.range_offset.value;
    case range_scale:
      return c.range_scale;
    case scan_offset:
      return c.scan_offset.value;
    case scan_scale:
      return c.scan_scale;
    default:
      return c.latency.value;
  }
}

void set_value(core::Calibration& c, Parameter p, double value) {
  switch (p) {
    case boresight_roll:
      c.roll.value = value;
      break;
    case boresight_pitch:
      c.pitch.value = value;
      break;
    case boresight_heading:
      c.heading.value = value;
      break;
    case lever_forward:
    case lever_right:
    case lever_down:
      c.lever_arm_scanner[static_cast<size_t>(p - lever_forward)].value = value;
      break;
    case range_offset:
      c.range_offset.value = value;
      break;
    case range_scale:
      c.range_scale = value;
      break;
    case scan_offset:
      c.scan_offset.value = value;
      break;
    case scan_scale:
      c.scan_scale = value;
      break;
    default:
      c.latency.value = value;
  }
}

void move_plane(TiePlane& plane, const Eigen::Vector3d& d) {
  const auto axes = plane_axes(plane.normal);
  // normal . q - d1 u . q - d2 v . q = d0, brought to unit length; the centre goes to the nearest point of the new plane.
  const Vector3d turned = plane.normal - d[1] * axes[0] - d[2] * axes[1];
  const double length = turned.norm();
  plane.normal = turned / length;
  plane.centre += plane.normal * (d[0] / length);
}

bool condition_of(const TieProblem& p, const ShotGeometry& geometry, const TieState& state, const TieNoise& noise,
                  trajectory::Cursor& cursor, const TieGroup& g, size_t i, Condition& out) {
  const TieReturns& r = p.ties->returns;
  const double t = geometry.time(r.time[i]);
  if (!cursor.seek(t)) return false;
  trajectory::Pose pose = cursor.pose(t);
  if (p.knots->size() > 0) correct(pose, p.knots->at(g.line, t, state.correction));
  const Return record{r.angle[i], r.forward[i], r.range[i]};
  const Vector3d ecef = geometry.ecef_point(pose, record);
  if (!ecef.allFinite()) return false;

  const TiePlane& plane = state.planes[g.plane];
  const Matrix3d& local_R_ecef = p.ties->frame.local_R_ecef;
  const auto axes = plane_axes(plane.normal);
  const Vector3d normal = local_R_ecef.transpose() * plane.normal;
  const Vector3d d = local_R_ecef * (ecef - p.ties->frame.origin) - plane.centre;
  out.f = plane.normal.dot(d);

  // How records move the point, and so the variance of the condition.
  const auto square = [](double v) { return v * v; };
  const core::Calibration& c = geometry.calibration();
  const Vector3d beam = ecef - pose.position - pose.ecef_R_body * geometry.lever_arm();
  const double length = beam.norm(), along = normal.dot(beam);
  const Vector3d by_range = beam * (geometry.air().range_factor * c.range_scale / length);
  const Vector3d by_angle = pose.ecef_R_body *
                            (geometry.body_R_scanner() * geometry.beam()(geometry.angle(record.angle), record.forward).by_angle) *
                            (geometry.beam().ignores_record() ? 0.0 : length * c.scan_scale);
  out.range = square(normal.dot(by_range) * noise.range);
  out.angle = square(normal.dot(by_angle) * noise.angle) + square(noise.pointing) * std::max(0.0, square(length) - square(along));
  out.constant = square(normal.dot(pose.velocity) * noise.time) + square(state.roughness[g.plane]);
  out.depth = std::abs((local_R_ecef * beam).z());

  // Derivatives belong to the adjusted records (Gauss-Helmert): those of a point off its plane are correlated with its distance, and a
  // million such products bias what is weakly determined. The records' corrections that bring the point to its plane:
  const double k = -std::clamp(out.f, -most_correction * length, most_correction * length) / out.variance();
  const Vector3d pointed = (k * square(noise.pointing)) * (square(length) * normal - along * beam);
  const double turned = by_angle.squaredNorm();
  const double pointed_angle = turned > 0.0 ? by_angle.dot(pointed) / turned : 0.0;
  const Vector3d aside = pointed - pointed_angle * by_angle;  // by the pointing along the track, which no record holds
  Jacobian J;
  const Vector3d adjusted = aside + geometry.ecef_point(pose,
                                                        {record.angle + k * square(noise.angle) * normal.dot(by_angle) + pointed_angle,
                                                         record.forward, record.range + k * square(noise.range) * normal.dot(by_range)},
                                                        J);
  out.by = normal.transpose() * J;
  if (noise.pointing > 0.0) {
    const Vector3d down = -local_R_ecef.row(2).transpose();
    const Vector3d attitude_axes[3] = {pose.ecef_R_body.col(0), down.cross(pose.ecef_R_body.col(0)).normalized(), down};
    for (int q = 0; q < 3; ++q) {
      out.by[boresight_roll + q] += normal.dot((pose.ecef_R_body * geometry.boresight_axes().col(q)).cross(aside));
      out.by[attitude_roll + q] += normal.dot(attitude_axes[q].cross(aside));
    }
  }
  const Vector3d place = local_R_ecef * (adjusted - p.ties->frame.origin) - plane.centre;
  out.u = axes[0].dot(place);
  out.v = axes[1].dot(place);
  return true;
}

void add_moments(const RobustWeight& robust, const std::vector<Condition>& conditions, const float* deviation, double scale, double mean,
                 GroupBlock& block) {
  const double freedom = static_cast<double>(block.used) / (block.used - 1.0) / robust.consistency();
  for (const Condition& c : conditions) {
    const double z = *deviation++;
    if (!std::isfinite(c.f)) continue;
    const double share = robust(z / scale);
    if (share <= 0.0) continue;
    const double v = c.variance();
    const double e = share * (c.f - mean) * (c.f - mean) / v * freedom - c.constant / v;
    const double r = c.range / v, a = c.angle / v;
    block.moment[0] += r * r;
    block.moment[1] += r * a;
    block.moment[2] += a * a;
    block.moment[3] += r * e;
    block.moment[4] += a * e;
  }
}

TiePass linearise(const TieProblem& p, const TieState& state, const TieNoise& noise, double scale) {
  const size_t groups = p.ties->groups.size();
  TiePass pass;
  pass.blocks.resize(groups);
  pass.deviation.assign(p.ties->returns.size(), 0.0f);
  const ShotGeometry geometry(*p.scanner, state.calibration);
  const auto work = [&](size_t first, size_t last) {
    trajectory::Cursor cursor(*p.trajectory);
    Workspace workspace;
    for (size_t g = first; g < last; ++g) linearise_group(p, state, geometry, noise, scale, g, cursor, workspace, pass);
  };
  // Each group's block depends on nothing but the group: the answer is the same for any number of threads.
  const size_t threads = std::min<size_t>(std::max(1, p.threads), std::max<size_t>(1, groups / 16));
  std::vector<std::thread> others;
  for (size_t k = 1; k < threads; ++k) others.emplace_back(work, groups * k / threads, groups * (k + 1) / threads);
  work(0, groups / threads);
  for (std::thread& t : others) t.join();

  std::vector<double> sizes;
  sizes.reserve(pass.deviation.size());
  for (const float z : pass.deviation)
    if (std::isfinite(z)) sizes.push_back(std::abs(static_cast<double>(z)));
  pass.scale = std::max(least_scale, core::mad_to_sigma * core::median(std::move(sizes), 1.0));
  return pass;
}

}  // namespace swath::calib
