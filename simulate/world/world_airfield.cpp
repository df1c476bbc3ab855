// SPDX-License-Identifier: GPL-3.0-or-later
// The airfield: a place to calibrate over. One hall stands in each cell of a lattice over the area, so that the whole swath of every line
// meets some; ridges are spread evenly over the compass and slopes over their range, each in an order of its own.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/block.h"
#include "simulate/world/bearing.h"
#include "simulate/world/world.h"

namespace swath::simulate {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double apart = 6.0;                                                 // m between two buildings
constexpr double flattest = 20 * core::degree, steepest = 45 * core::degree;  // roofs of halls
constexpr double roof_fall = 0.02;                                            // steepest slope of the flat roof
constexpr double rim = 0.46;                                                  // share of the area's sides where trees stand

/// 0 .. n - 1 in an order of the random numbers.
std::vector<int> shuffled(int n, Random& random) {
  std::vector<int> order(static_cast<size_t>(n));
  std::iota(order.begin(), order.end(), 0);
  for (int i = n - 1; i > 0; --i)
    std::swap(order[static_cast<size_t>(i)], order[static_cast<size_t>(std::min(i, static_cast<int>(random.uniform() * (i + 1))))]);
  return order;
}

}  // namespace

double World::highest_corner(const Vector2d& centre, const Vector2d& along, double half_length, double half_width) const {
  double highest = relief_.height(centre.x(), centre.y());
  for (const double a : {-1.0, 1.0})
    for (const double c : {-1.0, 1.0}) {
      const Vector2d p = centre + a * half_length * along + c * half_width * Vector2d(along.y(), -along.x());
      highest = std::max(highest, relief_.height(p.x(), p.y()));
    }
  return highest;
}

bool World::is_built_near(const Vector2d& p, double radius) const {
  return std::any_of(buildings_.begin(), buildings_.end(),
                     [&](const Building& b) { return (b.centre - p).norm() < b.radius + radius + apart; });
}

void World::plan_airfield(const WorldOptions& options, const Features& f, std::int64_t seed, core::Radians direction) {
  Random random = random_of(seed, Stream::buildings);
  const Vector2d along = along_bearing(direction.value);
  const double hectares = options.length.value * options.width.value / 1e4;
  if (f.buildings > 0.0) {
    plan_flat_roof(options, along, random);
    plan_halls(options, std::max(1, static_cast<int>(std::lround(f.buildings * hectares))), direction, random);
  }
  plan_rim_trees(options, f, along, random_of(seed, Stream::trees));
}

void World::plan_flat_roof(const WorldOptions& options, const Vector2d& along, Random& random) {
  const BuildingSize s = airfield_building(options);
  const double base = highest_corner(Vector2d::Zero(), along, s.half_length, s.half_width);
  add_building(Vector2d::Zero(), along, s.half_length, s.half_width, base + s.height, 0.0, core::point_class::building);
  // The roof falls a little, in a direction of the seed's; it stays a plane.
  const Vector2d fall = random.uniform(0.0, roof_fall) * along_bearing(random.uniform(0, 2 * core::pi));
  const Vector3d normal = Vector3d(fall.x(), fall.y(), 1.0).normalized();
  Building& b = buildings_.back();
  b.planes.back() << normal, normal.z() * (base + s.height);
  b.top += fall.norm() * b.radius;
  b.name = "building";
}

void World::plan_halls(const WorldOptions& options, int halls, core::Radians direction, Random& random) {
  const Vector2d along = along_bearing(direction.value), across(along.y(), -along.x());
  const double length = options.length.value, width = options.width.value;
  const int columns = std::clamp(static_cast<int>(std::lround(std::sqrt(halls * length / width))), 1, std::max(1, halls));
  const int rows = (halls + columns - 1) / columns;
  const Vector2d cell(length / columns, width / std::max(1, rows));
  const double scale = std::min(1.0, cell.minCoeff() / 100.0);  // a small area has small halls
  const std::vector<int> cells = shuffled(columns * rows, random), ridges = shuffled(halls, random), slopes = shuffled(halls, random),
                         sizes = shuffled(halls, random);
  int built = 0;
  for (const int c : cells) {
    if (built == halls) break;
    const auto at = static_cast<size_t>(built);
    const double half_length = 0.5 * scale * (12.0 + 28.0 * (sizes[at] + random.uniform()) / halls);
    const double half_width = half_length * random.uniform(0.55, 0.8);
    const double slope = flattest + (steepest - flattest) * (slopes[at] + random.uniform()) / halls;
    const Vector2d ridge = along_bearing(direction.value + core::pi * (ridges[at] + random.uniform()) / halls);
    const double eaves = random.uniform(3.5, 7.0), radius = std::hypot(half_length, half_width);
    const Vector2d corner(-0.5 * length + cell.x() * (c % columns), -0.5 * width + cell.y() * (c / columns));
    const double margin_x = std::min(radius, 0.5 * cell.x()), margin_y = std::min(radius, 0.5 * cell.y());
    for (int attempt = 0; attempt < 200; ++attempt) {
      const double l = corner.x() + random.uniform(margin_x, cell.x() - margin_x),
                   w = corner.y() + random.uniform(margin_y, cell.y() - margin_y);
      const Vector2d p = l * along + w * across;
      if (is_built_near(p, radius) || relief_.is_water(p.x(), p.y())) continue;
      const double base = highest_corner(p, ridge, half_length, half_width) + eaves;
      add_building(p, ridge, half_length, half_width, base, base + half_width * std::tan(slope), core::point_class::building);
      buildings_.back().name = "hall " + std::to_string(++built);
      break;
    }
  }
}

void World::plan_rim_trees(const WorldOptions& options, const Features& f, const Vector2d& along, Random wood) {
  const Vector2d across(along.y(), -along.x());
  const double length = options.length.value, width = options.width.value;
  for (auto i = static_cast<int>(f.trees * (length * width / 1e4)); i > 0; --i) {
    // On one of the four sides, from `rim` of its half to the area's edge.
    const double side = wood.uniform(rim, 0.5) * (wood.uniform() < 0.5 ? -1.0 : 1.0), other = wood.uniform(-0.5, 0.5);
    const bool ends = wood.uniform() < 0.5;
    const double height = wood.uniform(5, 14), radius = std::max(1.0, 0.2 * height), extinction = f.foliage * wood.uniform(0.12, 0.4);
    const Vector2d p = (ends ? side : other) * length * along + (ends ? other : side) * width * across;
    if (is_built_near(p, radius)) continue;
    const double ground = relief_.height(p.x(), p.y()), crown = 0.65 * height;
    trees_.push_back({Vector3d(p.x(), p.y(), ground + height - crown / 2), radius, crown / 2, extinction, ground});
  }
}

}  // namespace swath::simulate
