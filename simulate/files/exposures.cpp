// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulate/files/exposures.h"

#include <Eigen/Geometry>
#include <cmath>

#include "core/geo/geodesy.h"
#include "simulate/files/events.h"

namespace swath::simulate {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double in_millimetres = 1e3;  // per metre

Vector3d metres_of(const std::array<core::Metres, 3>& v) { return {v[0].value, v[1].value, v[2].value}; }

Matrix3d mounting(const CameraOptions& c) {
  Matrix3d mounted;  // the image's x axis forward, its upper edge to the left
  mounted << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  return core::matrix_of({c.boresight[0].value, c.boresight[1].value, c.boresight[2].value}) *
         Eigen::AngleAxisd(c.mount.value, Vector3d::UnitZ()).toRotationMatrix() * mounted;
}

/// From the principal point, mm.
Vector2d distorted(const CameraOptions& c, const Vector2d& p) {
  const double x = p.x(), y = p.y(), r2 = x * x + y * y, radial = r2 * (c.k1 + r2 * (c.k2 + r2 * c.k3));
  return {x + x * radial + c.p1 * (r2 + 2.0 * x * x) + 2.0 * c.p2 * x * y, y + y * radial + c.p2 * (r2 + 2.0 * y * y) + 2.0 * c.p1 * x * y};
}

Vector2d principal_point(const CameraOptions& c) { return in_millimetres * Vector2d(c.x0.value, c.y0.value); }

}  // namespace

std::vector<CameraExposure> camera_exposures(const Flight& flight, const MapPatch& map, const Options& o) {
  const Matrix3d body_R_camera = mounting(o.camera);
  const core::Transform to_map(core::wgs84_ecef(), core::Crs(o.crs));
  std::vector<CameraExposure> out;
  for (const Event& e : plan_events(flight, o.events, o.seed)) {
    const Pose pose = flight.pose(e.t);
    CameraExposure x;
    x.id = e.id, x.line = e.line, x.t = e.t, x.attitude = pose.attitude;
    x.ecef_R_body = core::ecef_R_ned(pose.position.latitude, pose.position.longitude) * core::matrix_of(pose.attitude);
    x.ecef_R_camera = x.ecef_R_body * body_R_camera;
    const Vector3d imu = core::ecef_of(pose.position);
    x.centre = imu + x.ecef_R_body * metres_of(o.camera.lever_arm);
    x.antenna = imu + x.ecef_R_body * metres_of(o.mounting.lever_arm_antenna);
    x.on_map = to_map(x.centre) - map.map_origin();
    out.push_back(x);
  }
  return out;
}

std::optional<Vector2d> seen_at(const CameraOptions& c, const Vector3d& d) {
  if (!(d.z() < 0.0)) return {};
  const double f = in_millimetres * c.f.value;
  const Vector2d ideal = -f / d.z() * d.head<2>();
  const Vector2d half = 0.5 * in_millimetres * c.pixel.value * Vector2d(c.columns, c.rows);
  if (std::abs(ideal.x()) > 1.3 * half.x() || std::abs(ideal.y()) > 1.3 * half.y()) return {};  // the polynomial may fold far outside
  const Vector2d at = principal_point(c) + distorted(c, ideal);
  if (std::abs(at.x()) > half.x() || std::abs(at.y()) > half.y()) return {};
  return at;
}

Vector3d seen_from(const CameraOptions& c, const Vector2d& at) {
  const Vector2d target = at - principal_point(c);
  const double close = 1e-3 * in_millimetres * c.pixel.value;
  Vector2d ideal = target;
  for (int i = 0; i < 50; ++i) {
    const Vector2d miss = distorted(c, ideal) - target;
    if (miss.norm() < close) break;
    ideal -= miss;
  }
  return {ideal.x(), ideal.y(), -in_millimetres * c.f.value};
}

}  // namespace swath::simulate
