// SPDX-License-Identifier: GPL-3.0-or-later
// What wires must keep away from: returns of ground, vegetation and buildings around them.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <vector>

namespace swath::terrain {

enum class Hazard : std::uint8_t { ground, vegetation, building, wire };
constexpr int hazards = 4;
constexpr std::array<const char*, hazards> hazard_names{"ground", "vegetation", "building", "wire"};

/// A return of the corridor. Map frame minus an origin, m.
struct Obstacle {
  double x = 0.0, y = 0.0, z = 0.0;
  Hazard kind = Hazard::ground;
  Eigen::Vector3d at() const { return {x, y, z}; }
};

/// A height of the ground, m.
struct GroundHeight {
  double z = 0.0, sigma = 0.0;
};

/// Obstacles by cells in plan. They must live as long.
class Obstacles {
 public:
  explicit Obstacles(const std::vector<Obstacle>& all);
  /// Those with x and y in the box, and some around it.
  void in_box(double west, double south, double east, double north, const std::function<void(const Obstacle&)>& f) const;
  /// The plane of the ground returns within 2 m (4, 8 m where these are fewer than six), those beyond 3 sigmas left out; nothing where
  /// there are fewer than six within 8 m.
  std::optional<GroundHeight> ground(const Eigen::Vector2d& at) const;

 private:
  std::optional<GroundHeight> plane(const Eigen::Vector2d& at, double radius) const;
  const std::vector<Obstacle>& all_;
  std::map<std::pair<std::int64_t, std::int64_t>, std::vector<std::uint32_t>> cells_;
};

}  // namespace swath::terrain
