// SPDX-License-Identifier: GPL-3.0-or-later
// One pulse: the pose at its true time, the true beam, its echoes, then what the instrument records of them. The truth is the beam's
// equation itself, p = r_imu + ecef_R_ned ned_R_body (lever arm + body_R_scanner range beam), in ECEF, with the range found by the trace.
// True times are whole multiples of the resolution of a double of GPS time, so that the equation holds for them as stored.
#include "simulate/shoot.h"

#include <algorithm>
#include <cmath>

#include "core/block.h"
#include "simulate/scan.h"
#include "simulate/world/map_ray.h"

namespace swath::simulate {
namespace {

using Eigen::Vector3d;

constexpr double group_radius = 1.5, group_share = 0.6, group_scatter = 0.1;  // m, -, m: groups of low points

/// How far below the ground the group of low points at a place lies, m; 0 where there is none. One place in each cell of a lattice.
double group_depth(double per_hectare, std::int64_t seed, double x, double y) {
  const double side = std::max(std::sqrt(1e4 / per_hectare), 2 * group_radius);
  const auto i = static_cast<std::int64_t>(std::floor(x / side)), j = static_cast<std::int64_t>(std::floor(y / side));
  Random random = random_of(seed, Stream::low_groups, static_cast<std::uint64_t>(i) << 32 ^ (static_cast<std::uint64_t>(j) & 0xffffffffu));
  const double free = side - 2 * group_radius;
  const double cx = static_cast<double>(i) * side + group_radius + random.uniform() * free,
               cy = static_cast<double>(j) * side + group_radius + random.uniform() * free;
  return std::hypot(x - cx, y - cy) < group_radius ? random.uniform(1.0, 6.0) : 0.0;
}

double rounded(double v, double step) { return step > 0.0 ? step * std::round(v / step) : v; }

/// The beam turned by two small angles across itself.
Vector3d deflected(const Vector3d& beam, double one, double other) {
  const Vector3d u = Vector3d::UnitY().cross(beam).normalized(), v = beam.cross(u);
  return (beam + one * u + other * v).normalized();
}

}  // namespace

void append(Returns& to, const Returns& from) {
  for_each_column([&](auto column) { (to.*column).insert((to.*column).end(), (from.*column).begin(), (from.*column).end()); });
}

Shooter::Shooter(const Options& options, const World& world, const MapPatch& map, const Flight& flight, core::GpsTime start)
    : options_(options), world_(world), map_(map), flight_(flight), start_(start) {
  const core::Calibration& c = options.mounting.truth;
  body_R_scanner_ = core::matrix_of({c.roll.value, c.pitch.value, c.heading.value});
  lever_arm_ = {c.lever_arm_scanner[0].value, c.lever_arm_scanner[1].value, c.lever_arm_scanner[2].value};
}

std::int64_t Shooter::pulses(const Line& line) const {
  return static_cast<std::int64_t>(std::floor((line.end - line.start) * options_.scanner.prf.value));
}

void Shooter::shoot(const Line& line, std::int64_t first, std::int64_t last, Returns& out) const {
  Echoes echoes;
  for (std::int64_t k = first; k < last; ++k) pulse(line, k, echoes, out);
}

// One pulse on its way.
struct Shooter::Beam {
  core::GpsTime time;
  ScanState scan;
  Vector3d in_scanner;         // unit vector
  Vector3d origin, direction;  // ECEF
  Vector3d tangent, slope;     // the same in the map's tangent frame
  double begin, length;        // of the ray along it, m
  Ray ray;
};

bool Shooter::aim(const Line& line, std::int64_t number, Random& random, Beam& out) const {
  const ScannerOptions& scanner = options_.scanner;
  out.time = start_ + (line.start + static_cast<double>(number) / scanner.prf.value);
  const double t = out.time - start_;
  const Pose pose = flight_.pose(t);
  const Eigen::Matrix3d ecef_R_body = core::ecef_R_ned(pose.position.latitude, pose.position.longitude) * core::matrix_of(pose.attitude);
  out.origin = core::ecef_of(pose.position) + ecef_R_body * lever_arm_;

  out.scan = line.scans ? scan_at(scanner, t) : ScanState{};
  // A mirror that stands still reads 0.
  if (scanner.pattern == Pattern::profile || !line.scans) out.scan.angle = options_.mounting.truth.scan_offset.value;
  out.in_scanner = beam_of(scanner, out.scan.angle, out.scan.forward);
  if (!options_.noise.noise_free) {
    const double sigma = 0.25 * scanner.divergence.value;
    const double one = random.normal(), other = random.normal();
    out.in_scanner = deflected(out.in_scanner, sigma * one, sigma * other);
  }
  out.direction = ecef_R_body * (body_R_scanner_ * out.in_scanner);

  out.tangent = map_.tangent_of(out.origin);
  out.slope = map_.direction_of(out.direction);
  const auto on_map = ray_down(map_, world_.relief(), out.tangent, out.slope);
  if (!on_map) return false;
  out.ray = on_map->ray, out.begin = on_map->begin, out.length = on_map->length;
  return true;
}

void Shooter::displace(const Beam& beam, Random& error, Echoes& echoes) const {
  const NoiseOptions& noise = options_.noise;
  const double outlier = error.uniform();
  Echo& first = echoes.echo[0];
  Echo& last = echoes.echo[static_cast<size_t>(echoes.count - 1)];
  if (outlier < noise.high_points) {
    first.s -= error.uniform(10.0, std::max(11.0, 0.5 * beam.begin));
    first.kind = core::point_class::high_noise;
  } else if (outlier < noise.high_points + noise.low_points) {
    last.s += error.uniform(3.0, 25.0);
    last.kind = core::point_class::low_noise;
  } else if (outlier < noise.high_points + noise.low_points + noise.multipath) {
    last.s += error.uniform(0.5, 3.0);
    last.kind = core::point_class::low_noise;
  } else if (noise.low_groups > 0.0 && last.kind == core::point_class::ground) {
    const Vector3d foot = beam.ray.at(last.s);
    const double depth = group_depth(noise.low_groups, options_.seed, foot.x(), foot.y());
    if (depth > 0.0 && error.uniform() < group_share) {
      last.s += depth + group_scatter * error.normal();
      last.kind = core::point_class::low_noise;
    }
  }
}

void Shooter::record(const Line& line, const Beam& beam, const Echoes& echoes, Random& error, Returns& out) const {
  const NoiseOptions& noise = options_.noise;
  const ScannerOptions& scanner = options_.scanner;
  const core::Calibration& truth = options_.mounting.truth;
  const bool noisy = !noise.noise_free;
  double angle = beam.scan.angle;
  if (noisy) angle += noise.scan_angle.value * error.normal();
  double recorded_angle = scanner.pattern == Pattern::profile ? 0.0 : (angle - truth.scan_offset.value) / truth.scan_scale;
  if (noisy) recorded_angle = rounded(recorded_angle, scanner.angle_resolution.value);

  for (int i = 0; i < echoes.count; ++i) {
    const Echo& echo = echoes.echo[static_cast<size_t>(i)];
    const double range = beam.begin + echo.s;
    const Vector3d p = beam.origin + range * beam.direction;
    const Vector3d map = map_.map_of(beam.tangent + range * beam.slope) + map_.map_origin();
    double recorded = range, brightness = 0.0;
    if (noisy) {
      recorded += noise.range.value * error.normal();
      brightness = 0.03 * error.normal();
    }
    recorded = (recorded - truth.range_offset.value) / truth.range_scale;
    if (noisy) recorded = rounded(recorded, scanner.range_resolution.value);
    const double nominal = options_.flight.height.value / range;
    out.time.push_back(beam.time - truth.latency.value);
    out.angle.push_back(recorded_angle);
    out.forward.push_back(beam.scan.forward);
    out.range.push_back(recorded);
    out.intensity.push_back(std::clamp(std::round(2000 * echo.energy * (1 + brightness) * nominal * nominal), 1.0, 65535.0));
    out.number.push_back(i + 1);
    out.count.push_back(echoes.count);
    out.line.push_back(line.id);
    out.positive.push_back(beam.scan.positive);
    out.edge.push_back(beam.scan.edge);
    out.true_time.push_back(beam.time);
    out.x.push_back(p.x());
    out.y.push_back(p.y());
    out.z.push_back(p.z());
    out.east.push_back(map.x());
    out.north.push_back(map.y());
    out.height.push_back(map.z());
    out.true_range.push_back(range);
    out.true_angle.push_back(beam.scan.angle);
    out.beam_x.push_back(beam.in_scanner.x());
    out.beam_y.push_back(beam.in_scanner.y());
    out.beam_z.push_back(beam.in_scanner.z());
    out.kind.push_back(echo.kind);
  }
}

void Shooter::pulse(const Line& line, std::int64_t number, Echoes& echoes, Returns& out) const {
  const bool noisy = !options_.noise.noise_free;
  const auto index = static_cast<std::uint64_t>(line.id) << 40 | static_cast<std::uint64_t>(number);
  Random random = random_of(options_.seed, Stream::pulse, index);
  Beam beam;
  if (!aim(line, number, random, beam)) return;
  world_.trace(beam.ray, beam.length + 50.0, noisy ? beam.begin * options_.scanner.divergence.value : 0.0, random, echoes);
  detect(echoes, options_.scanner.separation.value, options_.scanner.max_returns);
  if (echoes.count == 0) return;
  Random error = random_of(options_.seed, Stream::noise, index);
  if (noisy) displace(beam, error, echoes);
  record(line, beam, echoes, error, out);
}

}  // namespace swath::simulate
