// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "simulate/options.h"
#include "simulate/random.h"
#include "simulate/world/relief.h"

namespace swath::simulate {

/// A beam on the map: q(s) = q0 + q1 s + q2 s^2, s metres along the straight beam minus `start`. A straight line is bent on the map by
/// the Earth's curvature; its cubic part is below 1e-8 m over 1 km.
struct Ray {
  Eigen::Vector3d q0, q1, q2;
  Eigen::Vector3d at(double s) const { return q0 + s * (q1 + s * q2); }
  Eigen::Vector3d slope(double s) const { return q1 + 2 * s * q2; }
};

/// What the beam meets.
struct Echo {
  double s = 0.0;       ///< along the ray, m
  double energy = 0.0;  ///< share of the pulse times reflectance
  double cosine = 1.0;  ///< of the angle between beam and surface normal
  std::uint8_t kind = 0;
};
struct Echoes {
  std::array<Echo, 24> echo;
  int count = 0;
  void add(const Echo& e) {
    if (count < static_cast<int>(echo.size())) echo[static_cast<size_t>(count++)] = e;
  }
};

/// Convex house, pole or bridge deck: inside where every plane has normal . p <= offset; open downwards (the ground closes it) but for
/// the deck.
struct Building {
  std::vector<Eigen::Vector4d> planes;  ///< unit normal, offset; absolute heights
  Eigen::Vector2d centre;
  double radius, top;
  std::uint8_t kind;
  std::string name;
};
/// Crown as an ellipsoid of revolution, half full of gaps: share of a beam that passes a path L is exp(-extinction L) on average.
struct Tree {
  Eigen::Vector3d centre;
  double radius, half_height, extinction, ground;
};
/// One wire between two poles: a catenary in a vertical plane. z = low + a (cosh((u - middle) / a) - 1), u along from `from`.
struct Wire {
  Eigen::Vector2d from, along;  ///< along: unit vector
  double length, middle, a, low, radius, top;
};

/// A field under crops of one height; 0: bare. `stopped`: share of the pulses that do not reach the soil.
struct Field {
  double height = 0.0, stopped = 0.0;
};

/// What covers a place, the first that holds: water, a building, a bridge, ground steeper than 30 degrees, crowns, crops and low
/// vegetation, open ground. The values of truth/cover.tif.
enum class Cover : std::uint8_t { open = 1, forest = 2, steep = 3, building = 4, low_vegetation = 5, water = 6, bridge = 7 };

/// Ground and objects, and the exact way of a beam among them. Coordinates as Relief.
class World {
 public:
  World(const WorldOptions& options, std::int64_t seed, core::Radians direction, double half);
  /// The same on ground that is given.
  World(const WorldOptions& options, Relief relief, std::int64_t seed, core::Radians direction, double half);

  const Relief& relief() const { return relief_; }
  const std::vector<Building>& buildings() const { return buildings_; }
  const std::vector<Tree>& trees() const { return trees_; }
  const std::vector<Wire>& wires() const { return wires_; }
  const std::vector<Field>& fields() const { return fields_; }

  /// Coordinates as Relief.
  Cover cover_at(double e, double n) const;

  /// First meeting of ray and ground, to 1e-7 m of height; the ray starts above the ground. False where it meets none within `far`.
  bool ground_hit(const Ray& ray, double far, double& s) const;

  /// All echoes of one pulse, in order of s. `footprint`: diameter of the beam at the ground, m (0: a line).
  void trace(const Ray& ray, double far, double footprint, Random& random, Echoes& out) const;

 private:
  enum class Sort : std::uint32_t { building, tree, wire };
  void plan_buildings(const WorldOptions& options, const Features& f, std::int64_t seed, core::Radians direction);
  void plan_hall(const WorldOptions& options, const Features& f, std::int64_t seed, core::Radians direction);
  void plan_bridge(const WorldOptions& options, std::int64_t seed, core::Radians direction);
  void plan_fields(const WorldOptions& options, const Features& f, std::int64_t seed, core::Radians direction);
  Field field_at(double e, double n) const;
  void plan_airfield(const WorldOptions& options, const Features& f, std::int64_t seed, core::Radians direction);
  void plan_flat_roof(const WorldOptions& options, const Eigen::Vector2d& along, Random& random);
  void plan_halls(const WorldOptions& options, int halls, core::Radians direction, Random& random);
  void plan_rim_trees(const WorldOptions& options, const Features& f, const Eigen::Vector2d& along, Random random);
  bool is_built_near(const Eigen::Vector2d& p, double radius) const;
  double highest_corner(const Eigen::Vector2d& centre, const Eigen::Vector2d& along, double half_length, double half_width) const;
  void plan_power_line(const WorldOptions& options, std::int64_t seed, core::Radians direction);
  void plan_trees(const WorldOptions& options, const Features& f, std::int64_t seed, core::Radians direction);
  void add_building(const Eigen::Vector2d& centre, const Eigen::Vector2d& along, double half_length, double half_width, double eaves,
                    double ridge, std::uint8_t kind);
  void index_objects(double half);
  struct Path;  ///< of one pulse: what it meets
  void meet(std::uint32_t object, Path& path) const;
  void meet_objects(Path& path) const;
  double pass_crossings(Path& path, Random& random, Echoes& out) const;
  void end_on_surface(const Path& path, double energy, Random& random, Echoes& out) const;
  bool low_vegetation_at(const Eigen::Vector3d& q) const;

  Relief relief_;
  double low_vegetation_ = 0.0, low_vegetation_height_ = 0.0;
  std::vector<Building> buildings_;
  std::vector<Tree> trees_;
  std::vector<Wire> wires_;

  // Parcels in the area's own axes, row by row from `corner` (along, across).
  std::vector<Field> fields_;
  Eigen::Vector2d along_ = Eigen::Vector2d::Zero(), fields_corner_ = Eigen::Vector2d::Zero();
  int fields_along_ = 0, fields_across_ = 0;

  // Objects by square cells: objects_[begin_[c] .. begin_[c + 1]) of cell c, sort in the upper two bits; top_[c] their highest point.
  static constexpr double cell_ = 8.0;
  double west_ = 0.0, south_ = 0.0, highest_object_ = 0.0;
  int nx_ = 0, ny_ = 0;
  std::vector<std::uint32_t> begin_, objects_;
  std::vector<float> top_;
};

/// Those echoes a discrete-return receiver records: strong enough, no nearer than `separation` behind the one before, the first
/// `most` - 1 and the last.
void detect(Echoes& echoes, double separation, int most);

}  // namespace swath::simulate
