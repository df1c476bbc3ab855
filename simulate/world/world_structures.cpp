// SPDX-License-Identifier: GPL-3.0-or-later
// What a ground filter stumbles over beside houses and trees: a hall wider than its window, a bridge, fields of crops; and the map of
// what covers the ground.
#include <algorithm>
#include <cmath>

#include "core/block.h"
#include "simulate/world/bearing.h"
#include "simulate/world/world.h"

namespace swath::simulate {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double hall_height = 12.0;                                         // m
constexpr double deck_half_width = 5.0, deck_thickness = 0.8;                // m
constexpr double parcel_length = 50.0, parcel_width = 30.0, headland = 1.0;  // m
constexpr double steepest_field = 0.25;                                      // rise / run
constexpr int most_trees_in_field = 25;
constexpr double steep_cover = 0.577350269;  // tan 30 degrees

Vector2d right_of(const Vector2d& along) { return {along.y(), -along.x()}; }

}  // namespace

void World::plan_hall(const WorldOptions& options, const Features& f, std::int64_t seed, core::Radians direction) {
  Random random = random_of(seed, Stream::structures, 0);
  const Vector2d along = along_bearing(direction.value), across = right_of(along);
  const double half_length = 0.5 * options.hall_length.value, half_width = 0.5 * options.hall_width.value;
  const double length = options.length.value, width = options.width.value, radius = std::hypot(half_length, half_width);
  // In the built-up end of the area, whole within it; the driest of some places.
  const double near = -0.5 * length + half_length, far = std::max(near, -0.5 * length + f.built_up * length - half_length);
  const double side = std::max(0.0, 0.5 * width - radius);
  Vector2d place = Vector2d::Zero();
  for (int attempt = 0; attempt < 200; ++attempt) {
    place = random.uniform(near, far) * along + random.uniform(-side, side) * across;
    bool dry = true;
    for (int i = 0; i < 12; ++i) {
      const Vector2d p = place + radius * along_bearing(i * core::pi / 6);
      dry = dry && !relief_.is_water(p.x(), p.y());
    }
    if (dry) break;
  }
  const Vector2d ridge = along_bearing(direction.value + random.uniform(-0.3, 0.3));
  const double base = highest_corner(place, ridge, half_length, half_width);
  add_building(place, ridge, half_length, half_width, base + hall_height, 0.0, core::point_class::building);
}

void World::plan_bridge(const WorldOptions& options, std::int64_t seed, core::Radians direction) {
  const Relief::Ditch& ditch = *relief_.ditch();
  Random random = random_of(seed, Stream::structures, 1);
  const Vector2d along = along_bearing(direction.value), across = right_of(along), deck = ditch.normal;
  // Where the ditch's middle line is `w` right of the area's axis; on dry ground, clear of other structures.
  Vector2d place = Vector2d::Zero();
  for (int attempt = 0; attempt < 200; ++attempt) {
    const double w = random.uniform(-0.2, 0.05) * options.width.value;
    const double l = (ditch.offset - w * deck.dot(across)) / deck.dot(along);
    place = l * along + w * across;
    const Vector2d from = place - ditch.half_width * deck, to = place + ditch.half_width * deck;
    const bool clear = std::none_of(buildings_.begin(), buildings_.end(),
                                    [&](const Building& b) { return (b.centre - place).norm() < b.radius + ditch.half_width + 5.0; });
    if (clear && !relief_.is_water(from.x(), from.y()) && !relief_.is_water(to.x(), to.y())) break;
  }
  // The deck is a plane from bank to bank, level across.
  const Vector2d from = place - ditch.half_width * deck, to = place + ditch.half_width * deck;
  const double z0 = relief_.height(from.x(), from.y()), z1 = relief_.height(to.x(), to.y());
  const double grade = (z1 - z0) / (2 * ditch.half_width), middle = 0.5 * (z0 + z1);
  add_building(place, deck, ditch.half_width, deck_half_width, middle, 0.0, core::point_class::bridge_deck);
  Building& b = buildings_.back();
  const Vector3d up = Vector3d(-grade * deck.x(), -grade * deck.y(), 1.0).normalized();
  const double offset = up.dot(Vector3d(place.x(), place.y(), middle));
  b.planes.back() << up, offset;
  b.planes.emplace_back(-up.x(), -up.y(), -up.z(), deck_thickness - offset);
  b.top = std::max(z0, z1);
  b.name = "bridge";
}

void World::plan_fields(const WorldOptions& options, const Features& f, std::int64_t seed, core::Radians direction) {
  along_ = along_bearing(direction.value);
  const Vector2d across = right_of(along_);
  fields_along_ = static_cast<int>(options.length.value / parcel_length);
  fields_across_ = static_cast<int>(options.width.value / parcel_width);
  fields_corner_ = {-0.5 * fields_along_ * parcel_length, -0.5 * fields_across_ * parcel_width};
  const auto count = static_cast<size_t>(fields_along_) * static_cast<size_t>(fields_across_);
  fields_.assign(count, {});
  const double radius = 0.5 * std::hypot(parcel_length, parcel_width);
  for (size_t k = 0; k < count; ++k) {
    const double l = fields_corner_.x() + (static_cast<double>(k % static_cast<size_t>(fields_along_)) + 0.5) * parcel_length,
                 w = fields_corner_.y() + (static_cast<double>(k / static_cast<size_t>(fields_along_)) + 0.5) * parcel_width;
    const Vector2d centre = l * along_ + w * across;
    Random random = random_of(seed, Stream::fields, k);
    if (random.uniform() >= f.crops) continue;
    if (std::any_of(buildings_.begin(), buildings_.end(),
                    [&](const Building& b) { return (b.centre - centre).norm() < b.radius + radius; }))
      continue;
    const auto stands_here = [&](const Tree& t) {
      const Vector2d d = t.centre.head<2>() - centre;
      return std::abs(d.dot(along_)) < 0.5 * parcel_length && std::abs(d.dot(across)) < 0.5 * parcel_width;
    };
    if (std::count_if(trees_.begin(), trees_.end(), stands_here) > most_trees_in_field) continue;
    bool tilled = true;
    for (int i = 0; i <= 10; ++i)
      for (int j = 0; j <= 6; ++j) {
        const Vector2d p = centre + (i / 10.0 - 0.5) * parcel_length * along_ + (j / 6.0 - 0.5) * parcel_width * across;
        const Relief::Sample ground = relief_.at(p.x(), p.y());
        tilled = tilled && !ground.water && ground.gradient.norm() < steepest_field;
      }
    if (tilled) fields_[k] = {random.uniform(0.1, options.crop_height.value), random.uniform(0.4, 0.8)};
  }
}

Field World::field_at(double e, double n) const {
  if (fields_.empty()) return {};
  const Vector2d p(e, n);
  const double l = (along_.dot(p) - fields_corner_.x()) / parcel_length, w = (right_of(along_).dot(p) - fields_corner_.y()) / parcel_width;
  const int i = static_cast<int>(std::floor(l)), j = static_cast<int>(std::floor(w));
  if (i < 0 || j < 0 || i >= fields_along_ || j >= fields_across_) return {};
  const double edge = std::min(std::min(l - i, i + 1 - l) * parcel_length, std::min(w - j, j + 1 - w) * parcel_width);
  if (edge < headland) return {};
  return fields_[static_cast<size_t>(j) * static_cast<size_t>(fields_along_) + static_cast<size_t>(i)];
}

Cover World::cover_at(double e, double n) const {
  const Relief::Sample ground = relief_.at(e, n);
  if (ground.water) return Cover::water;
  const Vector2d p(e, n);
  bool under_crown = false, on_bridge = false;
  const int i = static_cast<int>(std::floor((e - west_) / cell_)), j = static_cast<int>(std::floor((n - south_) / cell_));
  if (i >= 0 && j >= 0 && i < nx_ && j < ny_) {
    const size_t c = static_cast<size_t>(j) * static_cast<size_t>(nx_) + static_cast<size_t>(i);
    for (std::uint32_t k = begin_[c]; k < begin_[c + 1]; ++k) {
      const std::uint32_t index = objects_[k] & 0x3fffffffu;
      const auto sort = static_cast<Sort>(objects_[k] >> 30);
      if (sort == Sort::tree) under_crown = under_crown || (trees_[index].centre.head<2>() - p).norm() < trees_[index].radius;
      if (sort != Sort::building) continue;
      const Building& b = buildings_[index];
      const bool below = std::all_of(b.planes.begin(), b.planes.end(), [&](const Eigen::Vector4d& plane) {
        return std::abs(plane.z()) > 1e-9 || plane.head<2>().dot(p) <= plane[3];
      });
      if (below && b.kind == core::point_class::building) return Cover::building;
      on_bridge = on_bridge || (below && b.kind == core::point_class::bridge_deck);
    }
  }
  if (on_bridge) return Cover::bridge;
  if (ground.gradient.norm() > steep_cover) return Cover::steep;
  if (under_crown) return Cover::forest;
  const bool low = field_at(e, n).height > 0.0 || (low_vegetation_ > 0.0 && low_vegetation_at({e, n, ground.height}));
  return low ? Cover::low_vegetation : Cover::open;
}

}  // namespace swath::simulate
