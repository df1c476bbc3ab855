// SPDX-License-Identifier: GPL-3.0-or-later
// No published source: planes by least squares in the cells of a lattice. A cell whose returns do not lie in a plane is left out, so that
// vegetation, edges and walls take no part.
#include "calib/geometry/geometry_pairs.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

#include "calib/terms.h"
#include "core/statistics.h"
#include "georef/shot_geometry.h"

namespace swath::calib {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr std::uint32_t fewest = 6;  // returns of a cell
constexpr double narrowest = 0.12;   // of the cell's side: smallest standard deviation of its returns in any direction
constexpr double steepest = 1.5;     // rise / run
constexpr size_t judged = 40;        // cells whose sigma is computed
constexpr double loose = 2.0;        // variance of a plane's height off its centre, in that at its centre

/// Cell of a return; its number.
using Placed = std::pair<std::uint64_t, std::uint32_t>;

std::uint64_t key_of_cell(double x, double y, double side) {
  const auto index = [side](double v) { return static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(v / side)) + (1ll << 31)); };
  return index(x) << 32 | (index(y) & 0xffffffffu);
}

bool fit(const PointColumns& p, const Placed* begin, const Placed* end, const GroundOptions& o, GroundCell& out) {
  const auto n = static_cast<double>(end - begin);
  const Vector3d base(p.x[begin->second], p.y[begin->second], p.z[begin->second]);
  Vector3d sum = Vector3d::Zero();
  for (const Placed* k = begin; k != end; ++k) sum += Vector3d(p.x[k->second], p.y[k->second], p.z[k->second]) - base;
  const Vector3d mean = sum / n;
  Eigen::Matrix3d S = Eigen::Matrix3d::Zero();
  for (const Placed* k = begin; k != end; ++k) {
    const Vector3d v = Vector3d(p.x[k->second], p.y[k->second], p.z[k->second]) - base - mean;
    S += v * v.transpose();
  }
  const double xx = S(0, 0) / n, xy = S(0, 1) / n, yy = S(1, 1) / n;
  const double determinant = xx * yy - xy * xy, half = 0.5 * (xx + yy);
  const double least = half - std::sqrt(std::max(half * half - determinant, 0.0));
  if (!(least > std::pow(narrowest * o.cell, 2))) return false;
  const double xz = S(0, 2) / n, yz = S(1, 2) / n, zz = S(2, 2) / n;
  out.slope = Vector2d(yy * xz - xy * yz, xx * yz - xy * xz) / determinant;
  out.rms = std::sqrt(std::max(0.0, (zz - out.slope.x() * xz - out.slope.y() * yz) * n / (n - 3)));
  out.n = static_cast<std::uint32_t>(end - begin);
  out.mean = base + mean;
  out.sample = begin[out.n / 2].second;
  return out.rms / std::sqrt(1 + out.slope.squaredNorm()) < o.smooth && out.slope.norm() < steepest;
}

Vector3d normal_of(const GroundCell& a, const GroundCell& b) {
  const Vector2d slope = 0.5 * (a.slope + b.slope);
  return Vector3d(-slope.x(), -slope.y(), 1.0).normalized();
}

}  // namespace

std::vector<PassGround> ground_of(const GeometrySample& sample, LocalPoints& points, const GroundOptions& o) {
  std::vector<PassGround> out;
  PointColumns p;
  std::vector<Placed> placed;
  for (const PassSample& s : sample.surfaces) {
    points.run(s.shots, p);
    placed.clear();
    for (std::uint32_t i = 0; i < p.x.size(); ++i)
      if (std::abs(p.x[i]) < 1e6 && std::abs(p.y[i]) < 1e6) placed.emplace_back(key_of_cell(p.x[i], p.y[i], o.cell), i);
    std::sort(placed.begin(), placed.end());
    PassGround& g = out.emplace_back();
    g.pass = s.pass;
    for (size_t first = 0, end = 0; first < placed.size(); first = end) {
      for (end = first; end < placed.size() && placed[end].first == placed[first].first;) ++end;
      if (end - first < fewest) continue;
      ++g.cells;
      GroundCell cell;
      cell.i = static_cast<std::int32_t>(static_cast<std::int64_t>(placed[first].first >> 32) - (1ll << 31));
      cell.j = static_cast<std::int32_t>(static_cast<std::int64_t>(placed[first].first & 0xffffffffu) - (1ll << 31));
      if (fit(p, placed.data() + first, placed.data() + end, o, cell)) g.smooth.push_back(cell);
    }
  }
  return out;
}

const GroundCell* cell_beside(const PassGround& ground, const Vector3d& place, double side) {
  const auto i = static_cast<std::int32_t>(std::floor(place.x() / side)), j = static_cast<std::int32_t>(std::floor(place.y() / side));
  const GroundCell* out = nullptr;
  double nearest = side;
  for (std::int32_t x = i - 1; x <= i + 1; ++x) {
    auto at =
        std::lower_bound(ground.smooth.begin(), ground.smooth.end(), std::pair(x, j - 1),
                         [](const GroundCell& c, const std::pair<std::int32_t, std::int32_t>& key) { return std::pair(c.i, c.j) < key; });
    for (; at != ground.smooth.end() && at->i == x && at->j <= j + 1; ++at)
      if (const double off = (at->mean - place).head<2>().norm(); off < nearest) nearest = off, out = &*at;
  }
  return out;
}

std::vector<SharedCell> shared_cells(const PassGround& a, const PassGround& b, double side) {
  std::vector<SharedCell> out;
  const auto before = [](const GroundCell& x, const GroundCell& y) { return std::pair(x.i, x.j) < std::pair(y.i, y.j); };
  for (size_t i = 0, j = 0; i < a.smooth.size() && j < b.smooth.size();) {
    const GroundCell &x = a.smooth[i], &y = b.smooth[j];
    if (before(x, y)) {
      ++i;
    } else if (before(y, x)) {
      ++j;
    } else {
      ++i, ++j;
      const Vector2d between = 0.5 * (x.mean + y.mean).head<2>();
      if ((x.mean - y.mean).head<2>().norm() > 0.4 * side) continue;
      const double za = x.mean.z() + x.slope.dot(between - x.mean.head<2>()), zb = y.mean.z() + y.slope.dot(between - y.mean.head<2>());
      out.push_back({&x, &y, (za - zb) * normal_of(x, y).z()});
    }
  }
  return out;
}

std::optional<double> take_out_water(std::vector<SharedCell>& shared, double sigma) {
  constexpr double far_off = 5.0, near = 2.5, constant = 1.5;  // sigmas
  constexpr double level = 0.05, one_height = 0.1;             // rise / run, m
  constexpr double most = 0.9;                                 // of the cells far off are water
  constexpr size_t fewest_cells = 10;
  const auto is_off = [&](const SharedCell& s) { return std::abs(s.apart) > far_off * sigma; };
  std::vector<double> apart, height, rest;
  size_t off = 0;
  for (const SharedCell& s : shared) {
    if (!is_off(s)) {
      rest.push_back(std::abs(s.apart));
      continue;
    }
    ++off;
    if (s.a->slope.norm() < level && s.b->slope.norm() < level) apart.push_back(s.apart), height.push_back(s.a->mean.z());
  }
  if (apart.size() < fewest_cells || rest.size() < std::max(fewest_cells, shared.size() / 10)) return std::nullopt;
  if (static_cast<double>(apart.size()) < most * static_cast<double>(off)) return std::nullopt;
  if (core::mad_to_sigma * core::median(std::move(rest), 0.0) > near * sigma) return std::nullopt;
  const auto spread = [&](std::vector<double>& v) {
    const double middle = core::median(std::vector<double>(v), 0.0);
    for (double& x : v) x = std::abs(x - middle);
    return std::pair(middle, core::mad_to_sigma * core::median(std::move(v), 0.0));
  };
  const auto [difference, varies] = spread(apart);
  if (varies > constant * sigma || spread(height).second > one_height + near * sigma) return std::nullopt;
  std::erase_if(shared, [&, middle = difference](const SharedCell& s) {
    return is_off(s) && s.a->slope.norm() < level && s.b->slope.norm() < level && std::abs(s.apart - middle) < far_off * sigma;
  });
  return difference;
}

Vector3d height_direction(const GroundCell& c) { return {-c.slope.x(), -c.slope.y(), 1.0}; }

Vector3d normal_of(const SharedCell& cells) { return normal_of(*cells.a, *cells.b); }

std::optional<CellSensitivity> look_at(const GroundCell& c, const core::Shots& s, const Vector3d& direction, const ShotGeometry& geometry,
                                       trajectory::Cursor& cursor, const trajectory::LocalFrame& frame) {
  const double t = geometry.time(s.time[c.sample]);
  if (!cursor.seek(t)) return std::nullopt;
  Jacobian J;
  geometry.ecef_point(cursor.pose(t), {s.angle[c.sample], s.forward.empty() ? 0.0 : s.forward[c.sample], s.range[c.sample]}, J);
  CellSensitivity out;
  out.by = (direction.transpose() * frame.local_R_ecef) * J;
  out.own = loose * (c.rms * c.rms) / c.n;
  out.sigma = cursor.sigma(t);
  if (!out.by.allFinite()) return std::nullopt;
  return out;
}

double predicted_difference(const std::vector<SharedCell>& shared, const core::Shots& a, const core::Shots& b, const ShotGeometry& geometry,
                            const core::SensorSigma& sensor, const trajectory::Trajectory& trajectory,
                            const trajectory::LocalFrame& frame) {
  trajectory::Cursor cursor(trajectory);
  const CalibrationCovariance C = calibration_covariance(sensor);
  const auto variance_of = [&](const CellSensitivity& look) {
    const Variances v = variances(sensor, look.sigma);
    double out = look.own;
    for (int k = position_north; k <= attitude_heading; ++k) out += v[static_cast<size_t>(k)] * look.by[k] * look.by[k];
    return out;
  };
  double squares = 0, n = 0;
  const size_t step = std::max<size_t>(1, shared.size() / judged);
  for (size_t k = 0; k < shared.size(); k += step) {
    const Vector3d normal = normal_of(shared[k]);
    const auto la = look_at(*shared[k].a, a, normal, geometry, cursor, frame);
    const auto lb = look_at(*shared[k].b, b, normal, geometry, cursor, frame);
    if (!la || !lb) continue;
    const Eigen::Matrix<double, 1, latency + 1> d = (la->by - lb->by).head<latency + 1>();
    squares += variance_of(*la) + variance_of(*lb) + d * C * d.transpose();
    n += 1;
  }
  return n > 0 ? std::sqrt(squares / n) : 0.0;
}

}  // namespace swath::calib
