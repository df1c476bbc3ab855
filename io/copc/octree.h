// SPDX-License-Identifier: GPL-3.0-or-later
// Which node of an octree holds which point: every level is a thinned picture of the cloud, twice as dense as the one above.
#pragma once

#include <Eigen/Core>
#include <array>
#include <compare>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace swath::io {

/// A node: cube x, y, z of the 2^level along each side of the root.
struct OctreeKey {
  std::int32_t level = 0, x = 0, y = 0, z = 0;
  auto operator<=>(const OctreeKey&) const = default;
  OctreeKey parent() const { return {level - 1, x >> 1, y >> 1, z >> 1}; }
  OctreeKey child(int octant) const { return {level + 1, x * 2 + (octant & 1), y * 2 + (octant >> 1 & 1), z * 2 + (octant >> 2 & 1)}; }
  /// "2-1-0-3", as EPT names files.
  std::string text() const;
};

/// A cube in the units of the coordinates.
struct OctreeCube {
  Eigen::Vector3d centre{0, 0, 0};
  double half_side = 1.0;

  /// Around the box of all points; its side is above 0.
  static OctreeCube around(const Eigen::Vector3d& low, const Eigen::Vector3d& high);
  Eigen::Vector3d low() const { return centre.array() - half_side; }
  double side() const { return 2.0 * half_side; }
  OctreeCube of(const OctreeKey& key) const;
};

namespace octree {
constexpr int cell_bits = 8;    ///< a node has 2^8 cells along its side and at most one point of its level in each
constexpr int depth_bits = 21;  ///< cells along the root's side at the deepest level: 2^21, three times 21 bits are one number
constexpr int max_level = depth_bits - cell_bits;
constexpr std::uint64_t leaf_points = 100000;  ///< a cube of as many points or fewer is not divided
}  // namespace octree

/// Place of a point on the curve that visits the cubes of every level one after the other (Morton order): three bits a level, the root's
/// children first. Points outside the cube count as at its rim.
std::uint64_t octree_code(const OctreeCube& cube, const Eigen::Vector3d& point);
/// The node of a level in which the code lies.
OctreeKey octree_key(std::uint64_t code, int level);

/// Level of each point. In every cell of a level the point with the lowest priority stands for the others in it, on this level or above;
/// a point's level is the first on which it does so. That depends on the points within the cell alone: any part of a cloud cut along
/// nodes of level `cell_bits` or above gets the levels that it has in the whole. `codes` ascend; where priorities are equal the first
/// counts.
std::vector<std::uint8_t> octree_levels(std::span<const std::uint64_t> codes, std::span<const std::uint64_t> priorities);

/// Points of a node: their numbers, ascending. May be empty where a node has children alone.
using OnNode = std::function<void(const OctreeKey&, std::vector<std::uint32_t>&)>;

/// Calls `on_node` for each node at or below `top` that has points or children with points, children first. Points whose level is above
/// that of `top` are left out. A cube of at most `leaf_points` keeps what its levels above do not have.
void visit_octree(const OctreeKey& top, std::span<const std::uint64_t> codes, std::span<const std::uint8_t> levels, const OnNode& on_node);

}  // namespace swath::io
