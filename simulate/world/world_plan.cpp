// SPDX-License-Identifier: GPL-3.0-or-later
// Where houses, the power line and trees stand: drawn once from the seed; and the index of cells over them.
#include <algorithm>
#include <cmath>

#include "core/block.h"
#include "simulate/world/bearing.h"
#include "simulate/world/world.h"

namespace swath::simulate {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr std::uint8_t tower_class = 15;  // ASPRS "transmission tower"

/// The area's own axes: along the flight lines and to their right.
struct Area {
  Vector2d along, across;
  double length, width;
  Area(const WorldOptions& o, core::Radians direction)
      : along(along_bearing(direction.value)), across(along.y(), -along.x()), length(o.length.value), width(o.width.value) {}
  Vector2d at(double l, double w) const { return l * along + w * across; }
  double hectares() const { return length * width / 1e4; }
};

}  // namespace

void World::add_building(const Vector2d& centre, const Vector2d& along, double half_length, double half_width, double eaves, double ridge,
                         std::uint8_t kind) {
  const Vector2d across(along.y(), -along.x());
  Building b{
      {}, centre, std::hypot(half_length, half_width), std::max(eaves, ridge), kind, "building " + std::to_string(buildings_.size() + 1)};
  const auto wall = [&](const Vector2d& n, double half) { b.planes.emplace_back(n.x(), n.y(), 0.0, n.dot(centre) + half); };
  wall(along, half_length);
  wall(-along, half_length);
  wall(across, half_width);
  wall(-across, half_width);
  if (ridge > eaves) {
    // Gable: the roof falls from the ridge (along) to the eaves on both sides.
    for (const double side : {1.0, -1.0}) {
      const Vector3d n = Vector3d(side * across.x() * (ridge - eaves), side * across.y() * (ridge - eaves), half_width).normalized();
      b.planes.emplace_back(n.x(), n.y(), n.z(), n.dot(Vector3d(centre.x(), centre.y(), ridge)));
    }
  } else {
    b.planes.emplace_back(0, 0, 1, eaves);
  }
  buildings_.push_back(std::move(b));
}

void World::plan_buildings(const WorldOptions& options, const Features& f, std::int64_t seed, core::Radians direction) {
  Random random = random_of(seed, Stream::buildings);
  const Area area(options, direction);
  // The built-up part is the end of the area that `along` points away from; houses keep to the streets' two directions.
  const double built_length = f.built_up * area.length;
  const int wanted = random.poisson(f.buildings * area.hectares() * f.built_up);
  const double street = direction.value + random.uniform(-0.5, 0.5);
  for (int i = 0; i < wanted; ++i) {
    for (int attempt = 0; attempt < 20; ++attempt) {
      const Vector2d centre = area.at(-0.5 * area.length + random.uniform() * built_length, random.uniform(-0.5, 0.5) * area.width);
      const bool big = random.uniform() < 0.15;
      const double half_length = big ? random.uniform(12, 25) : random.uniform(5, 9),
                   half_width = big ? random.uniform(7, 12) : random.uniform(4, 6);
      const double radius = std::hypot(half_length, half_width);
      const Vector2d along = along_bearing(street + (random.uniform() < 0.5 ? 0.0 : core::pi / 2) + random.uniform(-0.05, 0.05));
      const bool gable = !big && random.uniform() < 0.7;
      const double eaves = big ? random.uniform(6, 14) : random.uniform(3, 6.5), roof = random.uniform(1.5, 4.0);
      const auto clash = [&](const Building& b) { return (b.centre - centre).norm() < b.radius + radius + 3.0; };
      if (std::any_of(buildings_.begin(), buildings_.end(), clash) || relief_.is_water(centre.x(), centre.y())) continue;
      // The eaves count from the highest ground at the corners.
      double base = relief_.height(centre.x(), centre.y());
      bool dry = true;
      for (const double a : {-1.0, 1.0})
        for (const double c : {-1.0, 1.0}) {
          const Vector2d p = centre + a * half_length * along + c * half_width * Vector2d(along.y(), -along.x());
          const Relief::Sample g = relief_.at(p.x(), p.y());
          base = std::max(base, g.height);
          dry = dry && !g.water;
        }
      if (!dry) continue;
      add_building(centre, along, half_length, half_width, base + eaves, gable ? base + eaves + roof : 0.0, core::point_class::building);
      break;
    }
  }
}

void World::plan_power_line(const WorldOptions& options, std::int64_t seed, core::Radians direction) {
  Random random = random_of(seed, Stream::wires);
  const Area area(options, direction);
  // Across the whole area, a little oblique, three wires on masts of 22 m.
  const double spread = random.uniform(0.02, 0.12);
  const Vector2d from = area.at(spread * area.length, -0.55 * area.width), to = area.at((spread + 0.08) * area.length, 0.55 * area.width);
  const int spans = std::max(1, static_cast<int>(std::lround((to - from).norm() / 150.0)));
  const double length = (to - from).norm() / spans;
  const Vector2d along = (to - from).normalized(), across(along.y(), -along.x());
  constexpr double mast = 22.0, sag_share = 0.03, wire_radius = 0.015;
  const auto foot = [&](int k) { return Vector2d(from + k * length * along); };
  for (int k = 0; k <= spans; ++k) {
    const Vector2d p = foot(k);
    add_building(p, along, 0.25, 0.25, relief_.height(p.x(), p.y()) + mast + 0.5, 0.0, tower_class);
  }
  for (int k = 0; k < spans; ++k)
    for (const double offset : {-3.0, 0.0, 3.0}) {
      Wire w{foot(k) + offset * across, along, length, 0, 0, 0, wire_radius, 0};
      const Vector2d a = foot(k), b = foot(k + 1);
      const double z0 = relief_.height(a.x(), a.y()) + mast, z1 = relief_.height(b.x(), b.y()) + mast;
      // The catenary through both ends with a = length / (8 sag): its lowest point moves with the difference of heights.
      w.a = 1.0 / (8 * sag_share) * length;
      w.middle = length / 2 - w.a * std::asinh((z1 - z0) / (2 * w.a * std::sinh(length / (2 * w.a))));
      w.low = z0 - w.a * (std::cosh(w.middle / w.a) - 1);
      w.top = std::max(z0, z1);
      wires_.push_back(w);
    }
}

void World::plan_trees(const WorldOptions& options, const Features& f, std::int64_t seed, core::Radians direction) {
  Random random = random_of(seed, Stream::trees);
  const Area area(options, direction);
  const double wavelength = std::max(60.0, 0.25 * std::min(area.length, area.width));
  const double phase_l = random.uniform(0, 2 * core::pi), phase_w = random.uniform(0, 2 * core::pi);
  // Woodland where two crossed waves are high; the threshold is set by the wanted share of the area, from a sample of places.
  const auto density = [&](double l, double w) {
    return std::sin(2 * core::pi * l / wavelength / 1.7 + phase_l) + std::sin(2 * core::pi * w / wavelength + phase_w + 0.004 * l);
  };
  std::vector<double> sample;
  for (int i = 0; i < 40; ++i)
    for (int j = 0; j < 40; ++j) sample.push_back(density((i / 39.0 - 0.5) * area.length, (j / 39.0 - 0.5) * area.width));
  std::sort(sample.begin(), sample.end());
  const double threshold = sample[static_cast<size_t>((1 - f.woodland) * static_cast<double>(sample.size() - 1))];
  const auto wanted = static_cast<std::int64_t>(f.trees * area.hectares());
  for (std::int64_t i = 0; i < wanted; ++i) {
    const double l = random.uniform(-0.5, 0.5) * area.length, w = random.uniform(-0.5, 0.5) * area.width;
    const double height = random.uniform(4, 24) * random.uniform(0.7, 1.1), spread = random.uniform(0.16, 0.26);
    const double extinction = f.foliage * random.uniform(0.12, 0.4);
    // Some trees stand alone outside woodland.
    const bool alone = random.uniform() < 0.04;
    if (density(l, w) < threshold && !alone) continue;
    const Vector2d p = area.at(l, w);
    const Relief::Sample ground = relief_.at(p.x(), p.y());
    if (ground.water) continue;
    const double radius = std::max(1.0, spread * height);
    const auto clash = [&](const Building& b) { return (b.centre - p).norm() < b.radius + radius; };
    if (std::any_of(buildings_.begin(), buildings_.end(), clash)) continue;
    const auto under = [&](const Wire& v) {
      const double u = v.along.dot(p - v.from), across = std::abs(v.along.x() * (p - v.from).y() - v.along.y() * (p - v.from).x());
      return u > -10 && u < v.length + 10 && across < radius + 6 && height > 8;
    };
    if (std::any_of(wires_.begin(), wires_.end(), under)) continue;
    const double crown = random.uniform(0.5, 0.8) * height;
    trees_.push_back({Vector3d(p.x(), p.y(), ground.height + height - crown / 2), radius, crown / 2, extinction, ground.height});
  }
}

void World::index_objects(double half) {
  west_ = south_ = -half;
  nx_ = ny_ = std::max(1, static_cast<int>(std::ceil(2 * half / cell_)));
  const size_t cells = static_cast<size_t>(nx_) * static_cast<size_t>(ny_);
  highest_object_ = -1e300;
  struct Entry {
    std::uint32_t cell, object;
    float top;
  };
  std::vector<Entry> entries;
  const auto put = [&](const Vector2d& low, const Vector2d& high, double top, Sort sort, size_t index) {
    highest_object_ = std::max(highest_object_, top);
    const auto column = [&](double v, double from, int n) {
      return std::clamp(static_cast<int>(std::floor((v - from) / cell_)), 0, n - 1);
    };
    for (int j = column(low.y(), south_, ny_); j <= column(high.y(), south_, ny_); ++j)
      for (int i = column(low.x(), west_, nx_); i <= column(high.x(), west_, nx_); ++i)
        entries.push_back({static_cast<std::uint32_t>(j) * static_cast<std::uint32_t>(nx_) + static_cast<std::uint32_t>(i),
                           static_cast<std::uint32_t>(sort) << 30 | static_cast<std::uint32_t>(index), static_cast<float>(top)});
  };
  const Vector2d margin(0.5, 0.5);
  for (size_t k = 0; k < buildings_.size(); ++k) {
    const Vector2d r = Vector2d::Constant(buildings_[k].radius) + margin;
    put(buildings_[k].centre - r, buildings_[k].centre + r, buildings_[k].top, Sort::building, k);
  }
  for (size_t k = 0; k < trees_.size(); ++k) {
    const Vector2d r = Vector2d::Constant(trees_[k].radius) + margin, c = trees_[k].centre.head<2>();
    put(c - r, c + r, trees_[k].centre.z() + trees_[k].half_height, Sort::tree, k);
  }
  for (size_t k = 0; k < wires_.size(); ++k) {
    const int pieces = static_cast<int>(std::ceil(wires_[k].length / cell_));
    for (int i = 0; i < pieces; ++i) {
      const Vector2d a = wires_[k].from + wires_[k].along * wires_[k].length * i / pieces;
      const Vector2d b = wires_[k].from + wires_[k].along * wires_[k].length * (i + 1) / pieces;
      put(a.cwiseMin(b) - 2 * margin, a.cwiseMax(b) + 2 * margin, wires_[k].top, Sort::wire, k);
    }
  }
  std::sort(entries.begin(), entries.end(),
            [](const Entry& a, const Entry& b) { return a.cell < b.cell || (a.cell == b.cell && a.object < b.object); });
  entries.erase(
      std::unique(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) { return a.cell == b.cell && a.object == b.object; }),
      entries.end());
  begin_.assign(cells + 1, 0);
  top_.assign(cells, -1e30f);
  for (const Entry& e : entries) {
    ++begin_[e.cell + 1];
    top_[e.cell] = std::max(top_[e.cell], e.top);
    objects_.push_back(e.object);
  }
  for (size_t c = 0; c < cells; ++c) begin_[c + 1] += begin_[c];
}

}  // namespace swath::simulate
