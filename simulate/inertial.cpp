// SPDX-License-Identifier: GPL-3.0-or-later
// Strapdown equations in the local level frame (Savage 2000; Groves 2013, 5.4):
//   f_n = dv_n/dt + (2 w_ie + w_en) x v_n - g_n,  w_ib = w_nb + body_R_ned (w_ie + w_en).
// Increments by Gauss and Legendre with 4 nodes: error below 1e-13 rad and m/s over 5 ms of this flight.
#include "simulate/inertial.h"

#include <cmath>

#include "io/output_file.h"
#include "io/text_rows.h"
#include "simulate/random.h"

namespace swath::simulate {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Inertial inertial_of(const Motion& m) {
  const double lat = m.pose.position.latitude, h = m.pose.position.height;
  const double M = core::meridian_radius(lat), N = core::prime_vertical_radius(lat);
  const Vector3d w_ie(core::wgs84::omega * std::cos(lat), 0, -core::wgs84::omega * std::sin(lat));
  const Vector3d w_en(m.velocity.y() / (N + h), -m.velocity.x() / (M + h), -m.velocity.y() * std::tan(lat) / (N + h));
  const Vector3d gravity(0, 0, core::normal_gravity(lat, h));
  const Matrix3d body_R_ned = core::matrix_of(m.pose.attitude).transpose();
  const double roll = m.pose.attitude.roll, pitch = m.pose.attitude.pitch;
  const double p1 = m.attitude_rate.x(), q1 = m.attitude_rate.y(), r1 = m.attitude_rate.z();
  const Vector3d w_nb(p1 - r1 * std::sin(pitch), q1 * std::cos(roll) + r1 * std::sin(roll) * std::cos(pitch),
                      -q1 * std::sin(roll) + r1 * std::cos(roll) * std::cos(pitch));
  Inertial out;
  out.rate = w_nb + body_R_ned * (w_ie + w_en);
  out.force = body_R_ned * (m.acceleration + (2 * w_ie + w_en).cross(m.velocity) - gravity);
  return out;
}

Increments increments_of(const Flight& flight, double t, double step) {
  constexpr std::array<double, 2> x{0.3399810435848563, 0.8611363115940526}, w{0.6521451548625461, 0.3478548451374538};
  Increments out{Vector3d::Zero(), Vector3d::Zero()};
  for (size_t i = 0; i < 2; ++i)
    for (const double sign : {-1.0, 1.0}) {
      const Inertial at = inertial_of(flight.motion(t - 0.5 * step + sign * 0.5 * step * x[i]));
      out.angle += 0.5 * step * w[i] * at.rate;
      out.velocity += 0.5 * step * w[i] * at.force;
    }
  return out;
}

ImuErrors draw_imu_errors(ImuGrade grade, std::int64_t seed) {
  constexpr double deg_per_hour = core::degree / 3600, micro_g = 9.80665e-6, per_root_hour = 1.0 / 60;
  struct Spec {
    double gyro_bias, gyro_scale, angle_walk, accelerometer_bias, accelerometer_scale, velocity_walk;
  };
  Spec s{};
  switch (grade) {
    case ImuGrade::none:
    case ImuGrade::perfect:
      return {};
    case ImuGrade::navigation:
      s = {0.01, 10e-6, 0.005, 50, 50e-6, 0.01};
      break;
    case ImuGrade::tactical:
      s = {0.75, 300e-6, 0.1, 1000, 300e-6, 0.03};
      break;
    case ImuGrade::mems:
      s = {20, 1000e-6, 0.3, 4000, 1000e-6, 0.1};
      break;
  }
  Random random = random_of(seed, Stream::inertial, 0);
  ImuErrors e;
  for (size_t i = 0; i < 3; ++i) {
    e.gyro_bias[i] = s.gyro_bias * deg_per_hour * random.normal();
    e.gyro_scale[i] = s.gyro_scale * random.normal();
    e.accelerometer_bias[i] = s.accelerometer_bias * micro_g * random.normal();
    e.accelerometer_scale[i] = s.accelerometer_scale * random.normal();
  }
  e.angle_walk = s.angle_walk * core::degree * per_root_hour;
  e.velocity_walk = s.velocity_walk * per_root_hour;
  return e;
}

core::Value value_of(const ImuErrors& e) {
  core::Value v = core::Value::object();
  const auto put = [&v](const char* name, const std::array<double, 3>& a) {
    for (const double x : a) v[name].push(x);
  };
  put("gyro_bias_rad_per_s", e.gyro_bias);
  put("gyro_scale_factor", e.gyro_scale);
  put("accelerometer_bias_m_per_s2", e.accelerometer_bias);
  put("accelerometer_scale_factor", e.accelerometer_scale);
  v["angular_random_walk_rad_per_sqrt_s"] = e.angle_walk;
  v["velocity_random_walk_m_per_s_per_sqrt_s"] = e.velocity_walk;
  return v;
}

void write_imu(const std::filesystem::path& file, const Flight& flight, core::GpsTime start, const ImuErrors& e, std::int64_t seed) {
  io::TextRows rows(file, "gps_sow_s,dtheta_x_rad,dtheta_y_rad,dtheta_z_rad,dv_x_mps,dv_y_mps,dv_z_mps\n");
  const double week = core::seconds_per_week * core::week_of(start);
  const auto steps = static_cast<std::int64_t>(std::floor(flight.duration() / imu_step));
  for (std::int64_t k = 1; k <= steps; ++k) {
    Random random = random_of(seed, Stream::inertial, static_cast<std::uint64_t>(k));
    const double t = static_cast<double>(k) * imu_step;
    const Increments i = increments_of(flight, t, imu_step);
    rows.number(start - week + t, 4);
    for (Eigen::Index a = 0; a < 3; ++a) {
      const auto n = static_cast<size_t>(a);
      rows.scientific(i.angle[a] * (1 + e.gyro_scale[n]) + e.gyro_bias[n] * imu_step + e.angle_walk * std::sqrt(imu_step) * random.normal(),
                      12);
    }
    for (Eigen::Index a = 0; a < 3; ++a) {
      const auto n = static_cast<size_t>(a);
      rows.scientific(i.velocity[a] * (1 + e.accelerometer_scale[n]) + e.accelerometer_bias[n] * imu_step +
                          e.velocity_walk * std::sqrt(imu_step) * random.normal(),
                      12);
    }
    rows.end();
  }
  rows.commit();
}

void write_gnss(const std::filesystem::path& file, const Flight& flight, core::GpsTime start, const std::array<core::Metres, 3>& lever_arm,
                bool noise_free, std::int64_t seed) {
  io::TextRows rows(
      file,
      "gps_sow_s,lat_deg,lon_deg,h_ell_m,ecef_x_m,ecef_y_m,ecef_z_m,cov_xx_m2,cov_xy_m2,cov_xz_m2,cov_yy_m2,cov_yz_m2,cov_zz_m2,"
      "sd_north_m,sd_east_m,sd_down_m,n_sat\n");
  const double week = core::seconds_per_week * core::week_of(start);
  const Vector3d lever(lever_arm[0].value, lever_arm[1].value, lever_arm[2].value);
  const auto steps = static_cast<std::int64_t>(std::floor(flight.duration() / gnss_step));
  for (std::int64_t k = 0; k <= steps; ++k) {
    Random random = random_of(seed, Stream::gnss, static_cast<std::uint64_t>(k));
    const double t = static_cast<double>(k) * gnss_step;
    const Pose pose = flight.pose(t);
    const Matrix3d R = core::ecef_R_ned(pose.position.latitude, pose.position.longitude);
    const int satellites = 10 + static_cast<int>(random.uniform() * 7);
    // 15 mm across and 30 mm up with 14 satellites.
    const double quality = std::sqrt(14.0 / satellites);
    const Vector3d sigma = quality * Vector3d(0.015, 0.015, 0.030);
    Vector3d p = core::ecef_of(pose.position) + R * core::matrix_of(pose.attitude) * lever;
    const Vector3d noise(random.normal(), random.normal(), random.normal());
    if (!noise_free) p += R * sigma.cwiseProduct(noise);
    const Matrix3d cov = R * sigma.cwiseAbs2().asDiagonal() * R.transpose();
    const core::Geodetic g = core::geodetic_of(p);
    rows.number(start - week + t, 3);
    rows.number(g.latitude / core::degree, 11);
    rows.number(g.longitude / core::degree, 11);
    rows.number(g.height, 4);
    for (Eigen::Index i = 0; i < 3; ++i) rows.number(p[i], 4);
    for (Eigen::Index i = 0; i < 3; ++i)
      for (Eigen::Index j = i; j < 3; ++j) rows.scientific(cov(i, j), 8);
    for (Eigen::Index i = 0; i < 3; ++i) rows.number(sigma[i], 4);
    rows.number(satellites, 0);
    rows.end();
  }
  rows.commit();
}

}  // namespace swath::simulate
