// SPDX-License-Identifier: GPL-3.0-or-later
// A small analytic world for the search for ties: ground, gabled houses, trees; straight lines with a restless aircraft; an ideal scanner.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <random>
#include <utility>
#include <vector>

#include "core/geo/frames.h"
#include "core/geo/geodesy.h"
#include "georef/shot_geometry.h"
#include "georef/shot_stream.h"
#include "trajectory/fix_window.h"
#include "trajectory/trajectory.h"

namespace swath::calib::test {

/// Convex: inside where every plane has normal . p <= offset.
struct House {
  std::vector<Eigen::Vector4d> planes;
  Eigen::Vector2d centre;
  double radius;
};

/// Gable with its ridge along `azimuth` (from east, counterclockwise), eaves and ridge above `floor`; ridge == eaves: a flat roof.
inline House gable(const Eigen::Vector2d& centre, double azimuth, double half_length, double half_width, double floor, double eaves,
                   double ridge) {
  House h{{}, centre, std::hypot(half_length, half_width)};
  const Eigen::Vector2d u(std::cos(azimuth), std::sin(azimuth)), v(-u.y(), u.x());
  const auto wall = [&](const Eigen::Vector2d& n, double half) { h.planes.emplace_back(n.x(), n.y(), 0.0, n.dot(centre) + half); };
  wall(u, half_length), wall(-u, half_length), wall(v, half_width), wall(-v, half_width);
  const double slope = (ridge - eaves) / half_width, c = 1.0 / std::hypot(1.0, slope);
  for (const double s : {1.0, -1.0}) {
    const Eigen::Vector3d n(c * slope * s * v.x(), c * slope * s * v.y(), c);
    h.planes.emplace_back(n.x(), n.y(), n.z(), n.dot(Eigen::Vector3d(centre.x(), centre.y(), floor + ridge)));
  }
  return h;
}

/// A straight line over the world: local east, north at its middle, height, azimuth clockwise from north.
struct Track {
  Eigen::Vector2d middle;
  double height, azimuth, length;
};

struct TieWorld {
  std::vector<House> houses;
  double hills = 0.0;   ///< amplitude, m
  double slope = 0.0;   ///< rise / run to the east
  double canopy = 0.0;  ///< east of `wood_from` every return lies at a random height up to here, m
  double wood_from = std::numeric_limits<double>::infinity();
  double range_noise = 0.02;  ///< m
  double prf = 30000.0, scans = 30.0, half_angle = 20.0 * core::degree, speed = 60.0;
  core::Scanner scanner;
  core::Calibration truth;
  trajectory::LocalFrame frame = trajectory::local_frame(core::ecef_of({47.9 * core::degree, 10.5 * core::degree, 600.0}));

  double ground(double x, double y) const { return slope * x + hills * std::sin(x / 31.0) * std::cos(y / 43.0); }

  /// Distance along a ray to the first surface.
  double hit(const Eigen::Vector3d& from, const Eigen::Vector3d& way) const {
    double s = -from.z() / way.z();
    for (int k = 0; k < 8; ++k) {
      const Eigen::Vector3d p = from + s * way;
      s += (ground(p.x(), p.y()) - p.z()) / (way.z() - slope * way.x());
    }
    const Eigen::Vector3d foot = from + s * way;
    for (const House& h : houses) {
      if ((foot.head<2>() - h.centre).norm() > h.radius + 12.0) continue;  // houses up to 20 m high under beams up to 30 deg
      double in = -1e9, out = 1e9;
      for (const Eigen::Vector4d& q : h.planes) {
        const double rate = q.head<3>().dot(way), gap = q[3] - q.head<3>().dot(from);
        if (rate > 0) out = std::min(out, gap / rate);
        if (rate < 0) in = std::max(in, gap / rate);
        if (rate == 0 && gap < 0) out = -1e9;
      }
      if (in < out && in < s) s = in;
    }
    return s;
  }
};

/// A flown world: trajectory and raw returns by line.
struct Flown {
  core::TrajectoryData data;
  std::vector<std::pair<int, core::Shots>> lines;  ///< id, returns

  /// In batches of the given size.
  ShotStream stream(size_t batch = 40000) const {
    return [this, batch](const std::function<void(int, const core::Shots&)>& f) {
      for (const auto& [id, all] : lines)
        for (size_t first = 0; first < all.size(); first += batch) {
          core::Shots part;
          core::for_each_column(part, all, [&](auto& to, const auto& from) {
            if (!from.empty())
              to.assign(from.begin() + static_cast<long>(first), from.begin() + static_cast<long>(std::min(first + batch, from.size())));
          });
          f(id, part);
        }
    };
  }
};

/// Flies the tracks one after another (a gap of 20 s between them); `noise` of the trajectory as a constant of each line (m, horizontal and
/// vertical). Line ids count from 1.
inline Flown fly(const TieWorld& world, const std::vector<Track>& tracks, unsigned seed, double noise = 0.0) {
  Flown out;
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  const ShotGeometry geometry(world.scanner, world.truth);
  double start = 1.4e9;
  core::TrajectoryData true_data;
  std::vector<std::pair<double, double>> spans;
  for (const Track& t : tracks) {
    const double seconds = t.length / world.speed, phase = 6.0 * uniform(random);
    const Eigen::Vector2d way(std::sin(t.azimuth), std::cos(t.azimuth));
    const Eigen::Vector3d shift = noise * Eigen::Vector3d(normal(random), normal(random), normal(random));
    spans.emplace_back(start + 0.5, start + 0.5 + seconds);
    for (int i = 0; i <= static_cast<int>((seconds + 1.0) * 100); ++i) {
      const double s = 0.01 * i;
      Eigen::Vector3d p;
      p << t.middle + way * (world.speed * (s - 0.5) - 0.5 * t.length), t.height + std::sin(0.5 * s + phase);
      for (core::TrajectoryData* d : {&true_data, &out.data}) {
        const core::Geodetic g = core::geodetic_of(world.frame.to_ecef(d == &out.data ? Eigen::Vector3d(p + shift) : p));
        d->time.push_back(start + s);
        d->latitude.push_back(g.latitude), d->longitude.push_back(g.longitude), d->height.push_back(g.height);
        d->roll.push_back(0.02 * std::sin(0.7 * s + phase)), d->pitch.push_back(0.03 + 0.01 * std::cos(0.5 * s + phase));
        d->heading.push_back(core::wrap_two_pi(t.azimuth + 0.02 * std::sin(0.3 * s + phase)));
      }
    }
    start += seconds + 20.0;
  }
  const trajectory::Trajectory flight(true_data, {}, "test");
  const trajectory::LocalFrame& f = world.frame;
  for (size_t k = 0; k < tracks.size(); ++k) {
    core::Shots shots;
    trajectory::Cursor cursor(flight);
    const auto n = static_cast<size_t>((spans[k].second - spans[k].first) * world.prf);
    for (size_t i = 0; i < n; ++i) {
      const double t = spans[k].first + static_cast<double>(i) / world.prf, phase = t * world.scans - std::floor(t * world.scans);
      if (!cursor.seek(geometry.time(t))) continue;
      const bool turns = !geometry.beam().is_across();
      const double angle = turns ? 2.0 * core::pi * phase : world.half_angle * (phase < 0.5 ? 4.0 * phase - 1.0 : 3.0 - 4.0 * phase);
      const trajectory::Pose pose = cursor.pose(geometry.time(t));
      const Eigen::Vector3d one = f.local_R_ecef * (geometry.ecef_point(pose, {angle, 0.0, 1000.0}) - f.origin);
      const Eigen::Vector3d two = f.local_R_ecef * (geometry.ecef_point(pose, {angle, 0.0, 1001.0}) - f.origin);
      const Eigen::Vector3d way = two - one, from = one - 1000.0 * way;
      double range = world.hit(from, way);
      const Eigen::Vector3d p = from + range * way;
      if (p.x() > world.wood_from) range -= world.canopy * uniform(random) / std::abs(way.z());
      shots.time.push_back(t);
      shots.angle.push_back(angle);
      shots.range.push_back(range + world.range_noise * normal(random));
      shots.return_number.push_back(1), shots.return_count.push_back(1);
    }
    out.lines.emplace_back(static_cast<int>(k) + 1, std::move(shots));
  }
  return out;
}

/// Houses of many sizes and directions in a square of half side `half`.
inline std::vector<House> village(int count, double half, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> u;
  std::vector<House> out;
  while (static_cast<int>(out.size()) < count) {
    const Eigen::Vector2d c(half * (2 * u(random) - 1), half * (2 * u(random) - 1));
    const double length = 6 + 10 * u(random), width = 4 + 3 * u(random), eaves = 3 + 4 * u(random), rise = 1.5 + 3 * u(random);
    const bool near =
        std::any_of(out.begin(), out.end(), [&](const House& h) { return (h.centre - c).norm() < h.radius + length + width; });
    if (!near) out.push_back(gable(c, core::pi * u(random), length, width, 0.0, eaves, eaves + rise));
  }
  return out;
}

}  // namespace swath::calib::test
