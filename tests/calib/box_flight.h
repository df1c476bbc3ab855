// SPDX-License-Identifier: GPL-3.0-or-later
// A calibration flight over a box on flat ground, shot analytically: no part of calib/ takes part in making it but the trajectory's poses.
#pragma once

#include <Eigen/Core>
#include <Eigen/LU>
#include <array>
#include <cmath>
#include <vector>

#include "calib/target/target_edges.h"
#include "calib/target/target_readings.h"
#include "core/geo/frames.h"
#include "core/geo/geodesy.h"
#include "core/records/sensor.h"
#include "georef/shot_stream.h"
#include "io/vector/control.h"
#include "tests/world/navigation.h"
#include "trajectory/trajectory.h"

namespace swath::calib::test {

enum class Footprint {
  point,   ///< the beam has no width
  jitter,  ///< the echo comes from a random place in the footprint, sigma a quarter of its diameter
  disc,    ///< every part of the footprint counts: first return where a twentieth of it hits, last return where a twentieth misses
};

struct BoxLine {
  int id = 1;
  double heading = 0.0;  ///< of the flight, rad
  double right = 0.0;    ///< the target's centre lies so far to the right, m
  double height = 700.0;
  bool profile = false;  ///< no scan
};

struct BoxFlight {
  double half_length = 30.0, half_width = 16.0, azimuth = 0.4, roof = 9.0;  ///< the box; m, rad
  std::vector<BoxLine> lines;
  core::Calibration truth;
  Footprint footprint = Footprint::point;
  bool several_returns = true;
  double divergence = 0.5e-3, spacing = 0.8, speed = 60.0, half_angle = 0.35, range_noise = 0.02, angle_noise = 0.0;
  // Errors of the delivered trajectory, one draw for each line.
  double position_error = 0.0, height_error = 0.0, level_error = 0.0, heading_error = 0.0;
  Eigen::Vector3d datum{0, 0, 0};  ///< east, north, up of the delivered trajectory
  double shed = 0.0;               ///< height of a second, smaller level box beside it (0: none)
  std::uint64_t seed = 1;
};

/// The flight's records and what the analysis is given.
struct BoxRecords {
  trajectory::LocalFrame frame;
  std::vector<std::pair<int, core::Shots>> shots;
  core::TrajectoryData delivered;
  std::vector<io::ControlPoint> control;
  core::SensorSigma sigma;
  TrajectoryCovariance covariance;

  ShotStream stream() const {
    return [this](const std::function<void(int, const core::Shots&)>& f) {
      for (const auto& [line, s] : shots) f(line, s);
    };
  }
};

inline BoxRecords fly(const BoxFlight& flight) {
  using Eigen::Vector2d;
  using Eigen::Vector3d;
  BoxRecords out;
  const core::Geodetic place{47.9 * core::degree, 10.5 * core::degree, 650.0};
  out.frame = trajectory::local_frame(core::ecef_of(place));
  swath::test::Dice dice(flight.seed);

  // The box.
  const Vector2d u(std::sin(flight.azimuth), std::cos(flight.azimuth)), v(u.y(), -u.x());
  const auto inside = [&](const Vector2d& p) {
    return std::abs(p.dot(u)) <= flight.half_length && std::abs(p.dot(v)) <= flight.half_width;
  };
  for (const auto& [a, b] : {std::pair{1, 1}, std::pair{1, -1}, std::pair{-1, -1}, std::pair{-1, 1}}) {
    const Vector2d c = a * flight.half_length * u + b * flight.half_width * v;
    io::ControlPoint p;
    p.name = "corner" + std::to_string(out.control.size() + 1);
    p.target = "hall";
    p.ecef = out.frame.to_ecef({c.x(), c.y(), flight.roof});
    p.sigma_h = p.sigma_v = 1e-4;
    out.control.push_back(p);
  }
  // First hit of a ray that comes down: roof, wall or ground; range along it, and whether it is the roof.
  const Vector2d shed_centre = 60.0 * v;
  const auto hit = [&](const Vector3d& from, const Vector3d& d, bool& on_roof) {
    const double to_roof = (flight.roof - from.z()) / d.z(), to_ground = -from.z() / d.z();
    on_roof = inside((from + to_roof * d).head<2>());
    if (on_roof) return to_roof;
    // A wall: where the ray enters the box between the two heights.
    double enter = to_roof, leave = to_ground;
    for (const auto& [axis, half] : {std::pair{u, flight.half_length}, std::pair{v, flight.half_width}}) {
      const double at = axis.dot(from.head<2>()), rate = axis.dot(d.head<2>());
      if (std::abs(rate) < 1e-12) {
        if (std::abs(at) > half) leave = -1.0;
        continue;
      }
      const double a = (-half - at) / rate, b = (half - at) / rate;
      enter = std::max(enter, std::min(a, b));
      leave = std::min(leave, std::max(a, b));
    }
    if (enter < leave) return enter;
    if (flight.shed > 0.0) {
      const double to_shed = (flight.shed - from.z()) / d.z();
      const Vector2d p = (from + to_shed * d).head<2>() - shed_centre;
      if (std::abs(p.x()) < 8.0 && std::abs(p.y()) < 8.0) return to_shed;
    }
    return to_ground;
  };

  const Eigen::Matrix3d body_R_scanner = core::matrix_of({flight.truth.roll.value, flight.truth.pitch.value, flight.truth.heading.value});
  Vector3d lever;
  for (int k = 0; k < 3; ++k) lever[k] = flight.truth.lever_arm_scanner[static_cast<size_t>(k)].value;
  double start = swath::test::motion_start;
  for (const BoxLine& line : flight.lines) {
    // Ten seconds, the target abeam in the middle.
    constexpr double half_time = 3.0, step = 0.005;
    const Vector2d along(std::sin(line.heading), std::cos(line.heading)), right(along.y(), -along.x());
    const double crab = 0.06, phase = core::pi * 2.0 * dice.uniform();
    core::TrajectoryData truth;
    const Vector3d shift(flight.position_error * dice.normal(), flight.position_error * dice.normal(), flight.height_error * dice.normal());
    const double roll_error = flight.level_error * dice.normal(), pitch_error = flight.level_error * dice.normal();
    const double heading_error = flight.heading_error * dice.normal();
    for (int i = 0; i <= static_cast<int>(2 * half_time / step); ++i) {
      const double s = i * step - half_time;
      const Vector2d p = s * flight.speed * along - line.right * right;
      const Vector3d local(p.x(), p.y(), flight.roof + line.height + 0.3 * std::sin(0.7 * s + phase));
      const auto add = [&](core::TrajectoryData& d, const Vector3d& at, double roll, double pitch, double heading) {
        const core::Geodetic g = core::geodetic_of(out.frame.to_ecef(at));
        d.time.push_back(start + s);
        d.latitude.push_back(g.latitude), d.longitude.push_back(g.longitude), d.height.push_back(g.height);
        d.roll.push_back(roll), d.pitch.push_back(pitch), d.heading.push_back(core::wrap_two_pi(heading));
      };
      const double roll = 0.015 * std::sin(1.1 * s + phase), pitch = 0.03 + 0.008 * std::sin(0.9 * s + 2 * phase);
      const double heading = line.heading + crab + 0.004 * std::sin(0.5 * s);
      add(truth, local, roll, pitch, heading);
      add(out.delivered, local + shift + flight.datum, roll + roll_error, pitch + pitch_error, heading + heading_error);
    }
    const trajectory::Trajectory exact(truth);
    core::Shots shots;
    const double reach = line.height * std::tan(flight.half_angle), scan_step = flight.spacing / flight.speed;
    const auto pulses = static_cast<int>(2.0 * reach / flight.spacing);
    const double target_angle = std::atan2(line.right, line.height);
    std::uint32_t record = 0;
    for (double scan = -half_time + 0.1; scan < half_time - 0.1; scan += scan_step)
      for (int k = 0; k < pulses; ++k) {
        // One way across, evenly on the ground; away from the target one pulse in a hundred is enough.
        const double share = (k + 0.5) / pulses, t = scan + share * 0.9 * scan_step;
        double angle = line.profile ? 0.0 : std::atan((2.0 * share - 1.0) * reach / line.height);
        const bool near = std::abs(t) * flight.speed < flight.half_length + 40.0 &&
                          (line.profile || std::abs(std::tan(angle) - std::tan(target_angle)) * line.height < flight.half_length + 40.0);
        if (!near && k % 97 != 0) continue;
        if (line.profile && k % 40 != 0) continue;
        const auto pose = exact.pose_at(start + t);
        const Eigen::Matrix3d R = out.frame.local_R_ecef * pose->ecef_R_body;
        const Vector3d from = out.frame.local_R_ecef * (pose->position - out.frame.origin) + R * lever;
        double a = angle;
        if (flight.angle_noise > 0.0) a += flight.angle_noise * dice.normal();
        const Vector3d centre(0.0, std::sin(a), std::cos(a));
        const auto beam = [&](double one, double other) {
          const Vector3d across(0.0, std::cos(a), -std::sin(a));
          return Vector3d(R * (body_R_scanner * (centre + one * Vector3d::UnitX() + other * across).normalized()));
        };
        double first = 0.0, last = 0.0;
        bool on_roof = false;
        if (flight.footprint == Footprint::jitter) {
          const double one = 0.25 * flight.divergence * dice.normal();
          first = last = hit(from, beam(one, 0.25 * flight.divergence * dice.normal()), on_roof);
        } else {
          first = last = hit(from, beam(0, 0), on_roof);
        }
        const Vector3d pierced = from + (flight.roof - from.z()) / beam(0, 0).z() * beam(0, 0);
        const double from_edge = std::min(std::abs(std::abs(pierced.head<2>().dot(u)) - flight.half_length),
                                          std::abs(std::abs(pierced.head<2>().dot(v)) - flight.half_width));
        if (flight.footprint == Footprint::disc && from_edge < flight.divergence * line.height) {
          constexpr int rings = 5;
          int roofs = 0, all = 0;
          double below = 0.0;
          for (int r = 0; r < rings; ++r)
            for (int q = 0; q < 6 * r + 1; ++q, ++all) {
              const double radius = 0.5 * flight.divergence * r / (rings - 0.5), turn = 2.0 * core::pi * q / (6 * r + 1);
              bool roof = false;
              const double range = hit(from, beam(radius * std::cos(turn), radius * std::sin(turn)), roof);
              roofs += roof;
              if (!roof) below = std::max(below, range);
            }
          const double roof_share = static_cast<double>(roofs) / all;
          const Vector3d d = beam(0, 0);
          if (roof_share >= 0.05) {
            first = (flight.roof - from.z()) / d.z();
            last = roof_share <= 0.95 && flight.several_returns ? below : first;
          } else {
            first = last = below;
          }
        }
        const auto put = [&](double range, int number, int count) {
          shots.time.push_back(start + t - flight.truth.latency.value);
          shots.angle.push_back((angle - flight.truth.scan_offset.value) / flight.truth.scan_scale);
          shots.range.push_back((range + flight.range_noise * dice.normal() - flight.truth.range_offset.value) / flight.truth.range_scale);
          shots.return_number.push_back(static_cast<std::uint8_t>(number));
          shots.return_count.push_back(static_cast<std::uint8_t>(count));
          shots.record.push_back(record++);
        };
        const bool two = last > first + 1.0;
        put(first, 1, two ? 2 : 1);
        if (two) put(last, 2, 2);
      }
    out.shots.push_back({line.id, shots});
    start += 120.0;
  }
  out.sigma.lever_arm.value = 0.0;
  out.sigma.range.value = flight.range_noise;
  out.sigma.scan_angle.value = flight.angle_noise;
  out.sigma.beam_divergence.value = flight.footprint == Footprint::point ? 0.0 : flight.divergence;
  Eigen::Matrix<double, 6, 1> variance;
  variance << flight.position_error, flight.position_error, flight.height_error, flight.level_error, flight.level_error,
      flight.heading_error;
  variance = variance.cwiseAbs2();
  out.covariance = [variance](const std::vector<double>& times) {
    Eigen::MatrixXd C = Eigen::MatrixXd::Zero(6 * static_cast<Eigen::Index>(times.size()), 6 * static_cast<Eigen::Index>(times.size()));
    for (Eigen::Index i = 0; i < static_cast<Eigen::Index>(times.size()); ++i) C.block<6, 6>(6 * i, 6 * i) = variance.asDiagonal();
    return C;
  };
  return out;
}

/// Opposite lines over the target at `azimuth` and across it, with it at the swath's edges.
inline std::vector<BoxLine> full_pattern(double azimuth, double height = 700.0, int first = 1) {
  const double pi = core::pi, side = 0.3 * height;
  return {
      {first, azimuth, 0.0, height},           {first + 1, azimuth + pi, 5.0, height},        {first + 2, azimuth, side, height},
      {first + 3, azimuth + pi, side, height}, {first + 4, azimuth + 0.5 * pi, -8.0, height}, {first + 5, azimuth - 0.5 * pi, 0.0, height}};
}

}  // namespace swath::calib::test
