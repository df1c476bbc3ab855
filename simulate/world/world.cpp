// SPDX-License-Identifier: GPL-3.0-or-later
// The beam among ground and objects. The ground is found by steps no longer than the gap above it allows (sphere tracing, Hart 1996,
// with the relief's bound of slope), then by Newton's method on the exact analytic height. Objects are met by the tangent of the ray
// at the ground (0.15 mm off at 40 m) and refined on the ray itself.
// Crowns: interceptions are a Poisson process along the path, each takes a random share (mean 0.6) of what is left, so that the mean
// transmission is Beer and Lambert's exp(-extinction L).
#include "simulate/world/world.h"

#include <algorithm>
#include <cmath>

#include "core/block.h"

namespace swath::simulate {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
namespace cls = core::point_class;

constexpr double mean_share = 0.6;       // of the beam's energy that one interception takes
constexpr double least_energy = 0.03;    // weakest echo the receiver sees
constexpr double specular_angle = 0.10;  // rad: 1-sigma width of the water's glint
constexpr double crop_bottom = 0.6;      // lowest echo of crops, share of their height
constexpr double diffuse_water = 0.02;   // share of pulses that come back from water elsewhere

double reflectance(std::uint8_t kind) {
  switch (kind) {
    case cls::ground:
      return 0.35;
    case cls::building:
      return 0.5;
    case cls::water:
      return 0.3;
    case cls::wire:
      return 0.6;
    default:
      return 0.45;
  }
}

std::uint8_t vegetation_class(double height) {
  return height < 2.0 ? cls::low_vegetation : height < 5.0 ? cls::medium_vegetation : cls::high_vegetation;
}

/// Where the tangent p + t d enters the building, and through which plane; false where it passes.
bool enter(const Building& b, const Vector3d& p, const Vector3d& d, double& t, size_t& plane) {
  double in = -1e300, out = 1e300;
  for (size_t i = 0; i < b.planes.size(); ++i) {
    const double along = b.planes[i].head<3>().dot(d), gap = b.planes[i][3] - b.planes[i].head<3>().dot(p);
    if (along < 0.0) {
      if (gap / along > in) in = gap / along, plane = i;
    } else if (along > 0.0) {
      out = std::min(out, gap / along);
    } else if (gap < 0.0) {
      return false;
    }
  }
  t = in;
  return in < out && in > -1e299;
}

bool cross(const Tree& tree, const Vector3d& p, const Vector3d& d, double& in, double& out) {
  const Vector3d scale(1 / tree.radius, 1 / tree.radius, 1 / tree.half_height);
  const Vector3d o = (p - tree.centre).cwiseProduct(scale), v = d.cwiseProduct(scale);
  const double a = v.squaredNorm(), b = o.dot(v), c = o.squaredNorm() - 1.0;
  const double root = b * b - a * c;
  if (root <= 0.0) return false;
  in = (-b - std::sqrt(root)) / a;
  out = (-b + std::sqrt(root)) / a;
  return true;
}

/// Nearest approach to a wire: the ray comes down through the wire's height there. Distance across both.
bool approach(const Wire& w, const Vector3d& p, const Vector3d& d, double& t, double& distance) {
  const Vector2d across(-w.along.y(), w.along.x());
  const double du = w.along.dot(d.head<2>()), u0 = w.along.dot(p.head<2>() - w.from);
  t = (w.low - p.z()) / d.z();
  for (int i = 0; i < 4; ++i) {
    const double x = (u0 + t * du - w.middle) / w.a;
    t -= (p.z() + t * d.z() - w.low - w.a * (std::cosh(x) - 1)) / (d.z() - std::sinh(x) * du);
  }
  const double u = u0 + t * du;
  if (u < 0 || u > w.length) return false;
  const double lateral = across.dot(p.head<2>() - w.from) + t * across.dot(d.head<2>());
  distance = std::abs(lateral) / std::sqrt(1 + std::pow(across.dot(d.head<2>()) / d.z(), 2));
  return true;
}

}  // namespace

World::World(const WorldOptions& options, std::int64_t seed, core::Radians direction, double half)
    : World(options, Relief(options, seed, direction, half), seed, direction, half) {}

World::World(const WorldOptions& options, Relief relief, std::int64_t seed, core::Radians direction, double half)
    : relief_(std::move(relief)) {
  const Features f = features_of(options);
  low_vegetation_ = f.low_vegetation;
  low_vegetation_height_ = options.low_vegetation_height.value;
  const bool airfield = options.scene == Scene::airfield;
  if (airfield) plan_airfield(options, f, seed, direction);
  if (!airfield && f.hall) plan_hall(options, f, seed, direction);
  if (f.bridge) plan_bridge(options, seed, direction);
  if (!airfield && f.buildings > 0.0) plan_buildings(options, f, seed, direction);
  if (f.power_line) plan_power_line(options, seed, direction);
  if (!airfield && f.trees > 0.0) plan_trees(options, f, seed, direction);
  if (f.crops > 0.0) plan_fields(options, f, seed, direction);
  index_objects(half);
}

bool World::ground_hit(const Ray& ray, double far, double& s) const {
  constexpr double near_enough = 0.3, precise = 1e-7;
  s = 0.0;
  for (int step = 0; step < 4000; ++step) {
    const Vector3d q = ray.at(s), d = ray.slope(s);
    const Relief::Sample ground = relief_.at(q.x(), q.y());
    const double gap = q.z() - ground.height;
    if (std::abs(gap) < precise) return true;
    const double approach_rate = ground.gradient.dot(d.head<2>()) - d.z();
    if (std::abs(gap) < near_enough && approach_rate > 0.2) {
      s += gap / approach_rate;
      continue;
    }
    // The gap closes by at most this much per metre of beam.
    const double closing = (std::abs(d.z()) + relief_.steepest() * d.head<2>().norm()) * 1.0001;
    s += gap / closing;
    if (s > far) return false;
  }
  return false;
}

struct World::Path {
  struct Crossing {
    double in, out;
    std::uint32_t object;
  };
  Path(const Ray& r, double width, double s) : ray(r), footprint(width), s_ground(s), q(r.at(s)), d(r.slope(s)), s_surface(s) {}
  const Ray& ray;
  double footprint, s_ground;
  Vector3d q, d;  // the ground's place and the ray's slope there
  // What stops the beam.
  double s_surface;
  std::uint8_t surface = cls::ground;
  Vector3d normal = Vector3d::UnitZ();
  // What it crosses before, each once.
  size_t crossed = 0, seen_count = 0;
  std::array<Crossing, 16> crossings;
  std::array<std::uint32_t, 128> seen;
};

void World::meet(std::uint32_t object, Path& path) const {
  for (size_t i = 0; i < path.seen_count; ++i)
    if (path.seen[i] == object) return;
  if (path.seen_count < path.seen.size()) path.seen[path.seen_count++] = object;
  const std::uint32_t index = object & 0x3fffffffu;
  double in = 0, to = 0;
  switch (static_cast<Sort>(object >> 30)) {
    case Sort::building: {
      size_t plane = 0;
      const Building& b = buildings_[index];
      if (!enter(b, path.q, path.d, in, plane) || path.s_ground + in >= path.s_surface) return;
      double s = path.s_ground + in;
      const Vector3d n = b.planes[plane].head<3>();
      for (int i = 0; i < 2; ++i) s += (b.planes[plane][3] - n.dot(path.ray.at(s))) / n.dot(path.ray.slope(s));
      path.s_surface = s;
      path.surface = b.kind;
      path.normal = n;
      return;
    }
    case Sort::tree:
      if (!cross(trees_[index], path.q, path.d, in, to)) return;
      break;
    case Sort::wire:
      if (!approach(wires_[index], path.q, path.d, in, to)) return;
      if (to > 0.5 * path.footprint + wires_[index].radius) return;
      break;
  }
  if (path.crossed < path.crossings.size()) path.crossings[path.crossed++] = {path.s_ground + in, path.s_ground + to, object};
}

// Objects in the cells that the ray passes between the ground and the height of the highest object: cells upward along the ray (Amanatides
// and Woo 1987).
void World::meet_objects(Path& path) const {
  const Vector3d &q = path.q, &d = path.d;
  const double rise = -d.z(), reach = std::max(0.0, highest_object_ - q.z()) / rise;
  int i = static_cast<int>(std::floor((q.x() - west_) / cell_)), j = static_cast<int>(std::floor((q.y() - south_) / cell_));
  const double vx = -d.x(), vy = -d.y();
  const auto first = [](double at, double low, int k, double v) {
    return v > 0 ? (low + (k + 1) * cell_ - at) / v : v < 0 ? (low + k * cell_ - at) / v : 1e300;
  };
  double tx = first(q.x(), west_, i, vx), ty = first(q.y(), south_, j, vy);
  const double step_x = vx == 0 ? 1e300 : cell_ / std::abs(vx), step_y = vy == 0 ? 1e300 : cell_ / std::abs(vy);
  for (double t = 0.0; t <= reach;) {
    if (i >= 0 && j >= 0 && i < nx_ && j < ny_) {
      const size_t c = static_cast<size_t>(j) * static_cast<size_t>(nx_) + static_cast<size_t>(i);
      if (static_cast<double>(top_[c]) > q.z() + t * rise - 0.5)
        for (std::uint32_t k = begin_[c]; k < begin_[c + 1]; ++k) meet(objects_[k], path);
    }
    if (tx < ty) {
      t = tx;
      tx += step_x;
      i += vx > 0 ? 1 : -1;
    } else {
      t = ty;
      ty += step_y;
      j += vy > 0 ? 1 : -1;
    }
  }
}

// Echoes of wires and crowns; the energy that is left.
double World::pass_crossings(Path& path, Random& random, Echoes& out) const {
  using Crossing = Path::Crossing;
  std::sort(path.crossings.begin(), path.crossings.begin() + static_cast<std::ptrdiff_t>(path.crossed),
            [](const Crossing& a, const Crossing& b) { return a.in < b.in || (a.in == b.in && a.object < b.object); });
  double energy = 1.0;
  for (size_t k = 0; k < path.crossed && energy > least_energy; ++k) {
    const Crossing& c = path.crossings[k];
    if (c.in >= path.s_surface) break;
    const std::uint32_t index = c.object & 0x3fffffffu;
    if (static_cast<Sort>(c.object >> 30) == Sort::wire) {
      const double share = path.footprint > 0 ? std::min(1.0, 4 / core::pi * 2 * wires_[index].radius / path.footprint) : 1.0;
      out.add({c.in, energy * share * reflectance(cls::wire), 1.0, cls::wire});
      energy *= 1 - share;
      continue;
    }
    const Tree& tree = trees_[index];
    double s = c.in;
    while (energy > least_energy) {
      s += random.exponential() * mean_share / tree.extinction;
      if (s >= std::min(c.out, path.s_surface)) break;
      const double share = random.uniform(2 * mean_share - 1, 1.0);
      out.add({s, energy * share * reflectance(cls::high_vegetation), 1.0, vegetation_class(path.ray.at(s).z() - tree.ground)});
      energy *= 1 - share;
    }
  }
  return energy;
}

void World::end_on_surface(const Path& path, double energy, Random& random, Echoes& out) const {
  const Vector3d &q = path.q, &d = path.d;
  const double cosine = std::clamp(-path.normal.dot(d) / d.norm(), 0.0, 1.0);
  const auto stop = [&](double low, double high, double least_share) {
    const double s = path.s_ground + random.uniform(low, high) / d.z();
    const double share = random.uniform(least_share, 1.0);
    out.add({s, energy * share * reflectance(cls::low_vegetation), 1.0, cls::low_vegetation});
    energy *= 1 - share;
  };
  const Field field = path.surface == cls::ground ? field_at(q.x(), q.y()) : Field{};
  if (field.height > 0.0) {
    if (random.uniform() < field.stopped) stop(crop_bottom * field.height, field.height, 0.5);
  } else if (path.surface == cls::ground && low_vegetation_ > 0.0 && low_vegetation_at(q) && random.uniform() < 0.35) {
    stop(0.1, low_vegetation_height_, 0.2);
  }
  if (path.surface == cls::water) {
    const double off = std::acos(cosine) / specular_angle;
    if (random.uniform() > diffuse_water + (1 - diffuse_water) * std::exp(-0.5 * off * off)) energy = 0.0;
  }
  out.add({path.s_surface, energy * reflectance(path.surface) * std::max(cosine, 0.1), cosine, path.surface});
}

void World::trace(const Ray& ray, double far, double footprint, Random& random, Echoes& out) const {
  out.count = 0;
  double s = 0.0;
  if (!ground_hit(ray, far, s)) return;
  Path path(ray, footprint, s);
  const Relief::Sample ground = relief_.at(path.q.x(), path.q.y());
  if (ground.water) path.surface = cls::water;
  path.normal = Vector3d(-ground.gradient.x(), -ground.gradient.y(), 1.0).normalized();
  if (!objects_.empty()) meet_objects(path);
  const double energy = pass_crossings(path, random, out);
  end_on_surface(path, energy, random, out);
  std::sort(out.echo.begin(), out.echo.begin() + out.count, [](const Echo& a, const Echo& b) { return a.s < b.s; });
}

bool World::low_vegetation_at(const Vector3d& q) const {
  // Patches by two crossed waves; their product's distribution makes the share.
  const double v = 0.5 + 0.5 * std::sin(0.043 * q.x() + 0.017 * q.y() + 1.0) * std::sin(0.029 * q.y() - 0.021 * q.x());
  return v > 1.0 - low_vegetation_;
}

void detect(Echoes& echoes, double separation, int most) {
  int kept = 0;
  double last = -1e300;
  for (int i = 0; i < echoes.count; ++i) {
    const Echo& e = echoes.echo[static_cast<size_t>(i)];
    if (e.energy < least_energy || e.s - last < separation) continue;
    last = e.s;
    echoes.echo[static_cast<size_t>(kept < most ? kept++ : most - 1)] = e;
  }
  echoes.count = kept;
}

}  // namespace swath::simulate
