// SPDX-License-Identifier: GPL-3.0-or-later
// A hangar made by numbers: targets on its four walls, stations around an aircraft, and what an instrument would measure there.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "core/config/units.h"
#include "core/geo/frames.h"
#include "io/survey/hangar_file.h"

namespace swath::test {

class MadeHangar {
 public:
  using Vector3d = Eigen::Vector3d;

  /// Half of the range of the targets' heights, m; 0: all in one plane.
  double height_half_range = 1.25;
  /// Factor on the noise that is added; the stated sigmas stay.
  double noise = 1.0;
  core::Attitude attitude{0.5 * core::degree, -1.0 * core::degree, 37.0 * core::degree};

  std::vector<Vector3d> targets, stations;
  struct Point {
    const char* name;
    io::HangarRole role;
    Vector3d body, mark_to_point;
  };
  /// Body coordinates of the marks from the IMU's mark.
  std::vector<Point> points{{"imu mark", io::HangarRole::imu, {0, 0, 0}, {0.10, -0.05, 0.08}},
                            {"scanner", io::HangarRole::scanner, {0.42, -0.11, 0.35}, {0, 0, 0.06}},
                            {"roof", io::HangarRole::antenna, {-0.75, 0.21, -1.10}, {0, 0, -0.015}},
                            {"nose", io::HangarRole::fore, {3.1, 0.02, 0.1}, {0, 0, 0}},
                            {"tail", io::HangarRole::aft, {-4.2, 0.02, -0.3}, {0, 0, 0}}};

  /// From the imu to another point, as the lever arm should come out.
  Vector3d lever_arm(size_t from, size_t to) const {
    return points[to].body + points[to].mark_to_point - points[from].body - points[from].mark_to_point;
  }
  Vector3d in_hangar(const Vector3d& body) const {
    const Vector3d ned = core::matrix_of(attitude) * body;
    return Vector3d(8.5, 6.0, 1.1) + Vector3d(ned.y(), ned.x(), -ned.z());
  }

  void build() {
    const auto golden = [](int k) { return std::fmod(0.618033988749895 * k, 1.0); };
    targets.clear();
    for (int k = 0; k < 47; ++k) {
      double s = 58.0 * k / 47;  // along the walls of 17 m x 12 m
      const double z = 1.5 + height_half_range * (2 * golden(k) - 1);
      if (s < 17)
        targets.push_back({s, 0, z});
      else if ((s -= 17) < 12)
        targets.push_back({17, s, z});
      else if ((s -= 12) < 17)
        targets.push_back({17 - s, 12, z});
      else
        targets.push_back({0, 12 - (s - 17), z});
    }
    stations = {{5.2, 1.6, 1.62}, {12.9, 2.2, 1.55}, {14.1, 9.3, 1.81}, {4.4, 10.2, 1.47}, {8.0, 1.2, 2.05}, {2.1, 6.3, 1.7}};
  }

  /// What is measured there. Every station sees every third target or so, and the points from four stations each.
  io::HangarSurvey measure(unsigned seed) const {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    const auto off = [&](double sigma) { return noise * sigma * normal(random); };
    io::HangarSurvey h;
    h.name = "made";
    h.file = "hangar.toml";
    const auto metres = [](const Vector3d& v) {
      return std::array<core::Metres, 3>{core::Metres(v.x()), core::Metres(v.y()), core::Metres(v.z())};
    };
    for (size_t t = 0; t < targets.size(); ++t) h.targets.push_back({"T" + std::to_string(t + 1), metres(targets[t])});
    for (size_t s = 0; s < stations.size(); ++s) {
      io::HangarStation station;
      station.name = "S" + std::to_string(s + 1);
      h.stations.push_back(station);
    }
    const auto add_distance = [&](size_t s, const std::string& to, const Vector3d& at) {
      const double truth = (at - stations[s]).norm(), sigma = h.instrument.distance_sigma(truth);
      h.distances.push_back(
          {h.stations[s].name, to, core::Metres(truth + off(sigma)), core::Metres(sigma), "d" + std::to_string(h.distances.size())});
    };
    for (size_t s = 0; s < stations.size(); ++s)
      for (size_t t = s % 3; t < targets.size(); t += 3) add_distance(s, h.targets[t].name, targets[t]);
    const double sigma = h.instrument.angle.value;
    for (size_t p = 0; p < points.size(); ++p) {
      io::HangarPoint point;
      point.name = points[p].name;
      point.role = points[p].role;
      point.offset = metres(points[p].mark_to_point);
      h.points.push_back(point);
      const Vector3d at = in_hangar(points[p].body);
      for (size_t k = 0; k < 4; ++k) {
        const size_t s = (p + k) % stations.size();
        const Vector3d d = at - stations[s];
        for (size_t j = 0; j < 4; ++j) {
          const size_t other = (p + j) % stations.size();
          if (other == s) continue;
          const Vector3d base = stations[other] - stations[s];
          const double angle = std::abs(core::wrap_pi(std::atan2(d.x(), d.y()) - std::atan2(base.x(), base.y())));
          h.angles.push_back({h.stations[s].name, h.stations[other].name, point.name, core::Radians(angle + off(sigma)),
                              core::Radians(sigma), "a" + std::to_string(h.angles.size())});
        }
        h.verticals.push_back({h.stations[s].name, point.name, core::Radians(std::atan2(d.z(), d.head<2>().norm()) + off(sigma)),
                               core::Radians(sigma), "v" + std::to_string(h.verticals.size())});
        add_distance(s, point.name, at);
      }
    }
    h.axes.roll = core::Radians(attitude.roll + off(h.axes.roll_sigma.value));
    h.axes.pitch = core::Radians(attitude.pitch + off(h.axes.pitch_sigma.value));
    const Vector3d line = in_hangar(points[3].body) - in_hangar(points[4].body);
    h.axes.heading_offset =
        core::Radians(core::wrap_pi(attitude.heading - std::atan2(line.x(), line.y())) + off(h.axes.heading_sigma.value));
    return h;
  }
};

}  // namespace swath::test
