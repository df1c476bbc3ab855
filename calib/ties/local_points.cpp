// SPDX-License-Identifier: GPL-3.0-or-later
// The kernel of georef/georeference.cpp without map coordinates and sigmas. Deviations from georef/shot_geometry.h: the nadir in the
// refraction term is that of the trajectory interval's first record (1e-8 m); the ray is bent in the frame of that record (1e-8 m).
#include "calib/ties/local_points.h"

#include <cmath>
#include <cstdint>
#include <limits>
#include <unordered_set>
#include <utility>

#include "core/geo/frames.h"

namespace swath::calib {

using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {
constexpr double no_place = std::numeric_limits<double>::quiet_NaN();
constexpr double density_cell = 5.0;  // m
}  // namespace

LocalPoints::LocalPoints(const core::Scanner& scanner, const core::Calibration& calibration, const trajectory::Trajectory& trajectory,
                         const trajectory::LocalFrame& frame)
    : geometry_(scanner, calibration), frame_(frame), cursor_(trajectory) {}

void LocalPoints::enter_interval() {
  number_ = cursor_.number();
  const trajectory::Interval& k = cursor_.interval();
  local_R_base_ = frame_.local_R_ecef * k.base_attitude;
  for (int i = 0; i < 4; ++i) position_[i] = frame_.local_R_ecef * (i == 0 ? Vector3d(k.position[0] - frame_.origin) : k.position[i]);
  if (geometry_.air().bending != 0.0) down_ = k.base_attitude.transpose() * ecef_R_ned_at(k.pose(k.start)).col(2);
}

void LocalPoints::run(const core::Shots& shots, PointColumns& out) {
  const size_t n = shots.size();
  out.x.resize(n), out.y.resize(n), out.z.resize(n);
  const Matrix3d& B = geometry_.body_R_scanner();
  const Vector3d lever = geometry_.lever_arm();
  const double bending = geometry_.air().bending;
  const bool across = geometry_.beam().is_across();
  for (size_t i = 0; i < n; ++i) {
    out.x[i] = no_place;
    const double range = geometry_.range(shots.range[i]), angle = geometry_.angle(shots.angle[i]);
    const double forward = shots.forward.empty() ? 0.0 : shots.forward[i], t = geometry_.time(shots.time[i]);
    if (!(shots.range[i] > 0.0 && range > 0.0 && std::isfinite(range) && std::isfinite(angle) && std::abs(forward) <= 1.0)) continue;
    if (!(std::isfinite(t) && cursor_.seek(t))) continue;
    if (cursor_.number() != number_) enter_interval();
    const trajectory::Interval& k = cursor_.interval();
    Vector3d beam;
    if (across) {
      const double w = forward == 0.0 ? 1.0 : std::sqrt(1.0 - forward * forward);
      beam = {forward, w * std::sin(angle), w * std::cos(angle)};
    } else {
      beam = geometry_.beam()(angle, forward).direction;
    }
    const double s = t - k.start;
    const Vector3d ray = B * (range * beam);
    const Vector3d w = k.rotation[0] + s * (k.rotation[1] + s * (k.rotation[2] + s * k.rotation[3]));
    const double q = w.squaredNorm();
    const Vector3d arm = lever + ray;
    const Vector3d u = w.cross(arm);
    Vector3d turned;
    if (q < 0.01) {  // exp(w) by its series, exact to 3e-14
      const double a = 1.0 - q / 6.0 * (1.0 - q / 20.0 * (1.0 - q / 42.0)), b = 0.5 - q / 24.0 * (1.0 - q / 30.0 * (1.0 - q / 56.0));
      turned = arm + a * u + b * w.cross(u);
    } else {
      turned = core::exp_so3(w) * arm;
    }
    if (bending != 0.0) turned += refract(turned - lever, down_, bending) - (turned - lever);
    const Vector3d p = local_R_base_ * turned + (position_[0] + s * (position_[1] + s * (position_[2] + s * position_[3])));
    out.x[i] = p.x(), out.y[i] = p.y(), out.z[i] = p.z();
  }
}

std::optional<LocalPoints::Place> LocalPoints::place_at(double recorded) {
  const double t = geometry_.time(recorded);
  if (!(std::isfinite(t) && cursor_.seek(t))) return std::nullopt;
  const trajectory::Pose pose = cursor_.pose(t);
  Place out;
  out.local_R_body = frame_.local_R_ecef * pose.ecef_R_body;
  out.scanner = frame_.local_R_ecef * (pose.position - frame_.origin) + out.local_R_body * geometry_.lever_arm();
  return out;
}

std::optional<Matrix3d> LocalPoints::by_boresight(double recorded, const Return& r) {
  const double t = geometry_.time(recorded);
  if (!(std::isfinite(t) && cursor_.seek(t))) return std::nullopt;
  Jacobian by;
  geometry_.ecef_point(cursor_.pose(t), r, by);
  return frame_.local_R_ecef * by.middleCols<3>(boresight_roll);
}

void stream_points(const ShotStream& stream, LocalPoints& points, const std::function<void(double density)>& begin,
                   const std::function<void(int line, const core::Shots&, const PointColumns&)>& each) {
  PointColumns p;
  bool begun = !begin;
  std::vector<std::pair<int, core::Shots>> waiting;
  std::unordered_set<std::uint64_t> cells;
  size_t n = 0;
  const auto start = [&] {
    begun = true;
    begin(n == 0 ? no_place : static_cast<double>(n) / (static_cast<double>(cells.size()) * density_cell * density_cell));
    for (const auto& [line, shots] : waiting) points.run(shots, p), each(line, shots, p);
    waiting.clear();
  };
  stream([&](int line, const core::Shots& shots) {
    points.run(shots, p);
    if (begun) return each(line, shots, p);
    waiting.emplace_back(line, shots);
    bool enough = line != waiting.front().first;
    for (size_t i = 0; i < shots.size() && !enough; ++i) {
      if (!is_last_return(shots, i) || std::isnan(p.x[i])) continue;
      const auto index = [](double v) {
        return static_cast<std::uint64_t>(static_cast<std::uint32_t>(static_cast<std::int32_t>(std::floor(v / density_cell))));
      };
      cells.insert(index(p.x[i]) << 32 | index(p.y[i]));
      enough = ++n == density_sample;
    }
    if (enough) start();
  });
  if (!begun) start();
}

}  // namespace swath::calib
