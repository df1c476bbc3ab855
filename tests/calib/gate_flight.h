// SPDX-License-Identifier: GPL-3.0-or-later
// A small flight over hills with houses, for the tests of the geometry gate: two lines side by side, flown one against the other, and a
// cross line. Ranges are found on the ground itself, by nothing of calib but the beam.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "calib/geometry/geometry_gate.h"
#include "core/config/units.h"
#include "core/geo/frames.h"
#include "core/geo/geodesy.h"
#include "georef/beam.h"
#include "georef/shot_geometry.h"

namespace swath::calib::test {

struct GateFlight {
  static constexpr double deg = core::degree;
  core::TrajectoryData data;
  std::vector<RecordedLine> lines;
  std::vector<core::Shots> shots;  ///< by line
  Chain chain;                     ///< the true one
  core::SensorSigma sensor;
  double motions = 1.0;

  /// `waves`: size of the aircraft's motions.
  explicit GateFlight(bool flat = false, int count = 3, double waves = 1.0) : motions(waves) {
    core::Calibration& c = chain.calibration;
    c.roll = core::degrees(0.3);
    c.pitch = core::degrees(-0.4);
    c.heading = core::degrees(0.5);
    c.lever_arm_scanner = {core::Metres(0.9), core::Metres(-0.6), core::Metres(0.4)};
    sensor.range = core::Metres(0.01);
    const trajectory::LocalFrame frame = local();
    const struct { double x, y, course; } starts[] = {{-200, -50, 90}, {200, 50, 270}, {0, -200, 0}};
    for (int k = 0; k < count; ++k) fly(frame, k, starts[k].x, starts[k].y, starts[k].course * deg);
    const trajectory::Trajectory t(data);
    for (int k = 0; k < count; ++k) shoot(frame, t, k, flat);
  }

  static trajectory::LocalFrame local() { return trajectory::local_frame(core::ecef_of({47.9 * deg, 10.5 * deg, 600.0})); }
  static double ground(double x, double y, bool flat) {
    if (flat) return 0.0;
    const double u = std::fmod(x + 5000, 50.0), v = std::fmod(y + 5000, 40.0);
    const bool house = u < 14 && v < 10;
    return 1.5 * std::sin(x / 35) + 1.0 * std::cos(y / 27 + x / 60) + (house ? 6 - 0.7 * std::abs(v - 5) : 0.0);
  }
  GeometryInput input(const trajectory::Trajectory& t) const {
    GeometryInput in;
    in.shots = [this](const std::function<void(int, const core::Shots&)>& work) {
      for (size_t k = 0; k < shots.size(); ++k) work(lines[k].line, shots[k]);
    };
    in.lines = lines;
    in.chain = chain;
    in.sensor = sensor;
    in.trajectory = &t;
    std::vector<double> ranges = shots[0].range;
    std::nth_element(ranges.begin(), ranges.begin() + static_cast<std::ptrdiff_t>(ranges.size() / 2), ranges.end());
    in.range = ranges[ranges.size() / 2];
    return in;
  }
  GeometryFigures judged(double convergence = 0.0) const {
    const trajectory::Trajectory t(data);
    GeometryInput in = input(t);
    in.convergence = convergence;
    return judge_geometry(in, {});
  }

 private:
  static constexpr double speed = 50, seconds = 8, height = 300, apart = 40;

  void fly(const trajectory::LocalFrame& frame, int k, double x, double y, double course) {
    const double start = 1000 + k * (seconds + apart);
    for (int i = 0; i <= static_cast<int>((seconds + 2) * 100); ++i) {
      const double s = i * 0.01 - 1, t = start + s;
      const Eigen::Vector3d p(x + speed * s * std::sin(course), y + speed * s * std::cos(course), height + motions * 3 * std::sin(0.4 * t));
      const core::Geodetic g = core::geodetic_of(frame.to_ecef(p));
      data.time.push_back(t);
      data.latitude.push_back(g.latitude), data.longitude.push_back(g.longitude), data.height.push_back(g.height);
      data.roll.push_back(motions * 2.0 * deg * std::sin(2.1 * t));
      data.pitch.push_back(2.0 * deg + motions * 0.7 * deg * std::cos(1.3 * t));
      data.heading.push_back(core::wrap_two_pi(course + 1.5 * deg + motions * 0.5 * deg * std::sin(0.9 * t)));
      for (auto c : {&core::TrajectoryData::sigma_north, &core::TrajectoryData::sigma_east, &core::TrajectoryData::sigma_down})
        (data.*c).push_back(0.02f);
      for (auto c : {&core::TrajectoryData::sigma_roll, &core::TrajectoryData::sigma_pitch, &core::TrajectoryData::sigma_heading})
        (data.*c).push_back(static_cast<float>(0.003 * deg));
    }
    lines.push_back({k + 1, start, start + seconds, 0});
  }

  void shoot(const trajectory::LocalFrame& frame, const trajectory::Trajectory& t, int k, bool flat) {
    const ShotGeometry geometry(chain.scanner, chain.calibration);
    core::Shots& out = shots.emplace_back();
    constexpr double rate = 15000, sweeps = 25;
    trajectory::Cursor cursor(t);
    for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(seconds * rate); ++i) {
      const double s = i / rate, time = lines[static_cast<size_t>(k)].first + s;
      const double phase = std::fmod(s * sweeps, 1.0), angle = 20 * deg * (phase < 0.5 ? 4 * phase - 1 : 3 - 4 * phase);
      if (!cursor.seek(time)) continue;
      const trajectory::Pose pose = cursor.pose(time);
      const Eigen::Matrix3d R = frame.local_R_ecef * pose.ecef_R_body;
      const Eigen::Vector3d from = frame.local_R_ecef * (pose.position - frame.origin) + R * geometry.lever_arm();
      const Eigen::Vector3d way = R * (geometry.body_R_scanner() * geometry.beam()(angle, 0.0).direction);
      double range = -from.z() / way.z();
      for (int round = 0; round < 30; ++round) {
        const Eigen::Vector3d p = from + range * way;
        range += 0.7 * (p.z() - ground(p.x(), p.y(), flat)) / -way.z();
      }
      out.time.push_back(time);
      out.angle.push_back(angle);
      out.range.push_back(range);
      out.record.push_back(i);
    }
    lines[static_cast<size_t>(k)].records = out.size();
  }
};

}  // namespace swath::calib::test
