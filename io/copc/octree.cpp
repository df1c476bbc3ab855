// SPDX-License-Identifier: GPL-3.0-or-later
// Source: the octrees of EPT and COPC leave the choice of each level's points to the writer. Here priorities are nested: the point that
// stands for a cell stands for the smaller cell around it, too, so that levels follow from sorting once, without passing points up or down.
// Deviation: none of COPC 1.0. Cells at the deepest level are 2^-21 of the cube's side; points closer than that share the deepest node.
#include "io/copc/octree.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace swath::io {

namespace {

constexpr int code_bits = 3 * octree::depth_bits;

/// Bits of a coordinate's cell, two zeros between each.
std::uint64_t spread(std::uint64_t v) {
  v = (v | v << 32) & 0x001f00000000ffffu;
  v = (v | v << 16) & 0x001f0000ff0000ffu;
  v = (v | v << 8) & 0x100f00f00f00f00fu;
  v = (v | v << 4) & 0x10c30c30c30c30c3u;
  return (v | v << 2) & 0x1249249249249249u;
}
std::int32_t gathered(std::uint64_t v) {
  v &= 0x1249249249249249u;
  v = (v | v >> 2) & 0x10c30c30c30c30c3u;
  v = (v | v >> 4) & 0x100f00f00f00f00fu;
  v = (v | v >> 8) & 0x001f0000ff0000ffu;
  v = (v | v >> 16) & 0x001f00000000ffffu;
  v = (v | v >> 32) & 0x00000000001fffffu;
  return static_cast<std::int32_t>(v);
}

/// Levels of cells that two codes share.
int shared_depth(std::uint64_t a, std::uint64_t b) {
  return a == b ? octree::depth_bits : octree::depth_bits - 1 - (static_cast<int>(std::bit_width(a ^ b)) - 1) / 3;
}

class OctreeVisit {
 public:
  OctreeVisit(std::span<const std::uint64_t> codes, std::span<const std::uint8_t> levels, const OnNode& on_node)
      : codes_(codes), levels_(levels), on_node_(on_node) {}

  bool visit(const OctreeKey& key, std::size_t begin, std::size_t end) {
    const bool is_leaf = end - begin <= octree::leaf_points || key.level == octree::max_level;
    bool has_children = false;
    if (!is_leaf) {
      std::size_t at = begin;
      const int shift = code_bits - 3 * (key.level + 1);
      for (int octant = 0; octant < 8; ++octant) {
        const auto last =
            std::partition_point(codes_.begin() + static_cast<std::ptrdiff_t>(at), codes_.begin() + static_cast<std::ptrdiff_t>(end),
                                 [&](std::uint64_t c) { return static_cast<int>(c >> shift & 7u) <= octant; });
        const auto next = static_cast<std::size_t>(last - codes_.begin());
        if (next > at) has_children = visit(key.child(octant), at, next) || has_children;
        at = next;
      }
    }
    std::vector<std::uint32_t> mine;
    for (std::size_t i = begin; i < end; ++i)
      if (is_leaf ? levels_[i] >= key.level : levels_[i] == key.level) mine.push_back(static_cast<std::uint32_t>(i));
    if (mine.empty() && !has_children) return false;
    on_node_(key, mine);
    return true;
  }

 private:
  std::span<const std::uint64_t> codes_;
  std::span<const std::uint8_t> levels_;
  const OnNode& on_node_;
};

}  // namespace

std::string OctreeKey::text() const {
  return std::to_string(level) + "-" + std::to_string(x) + "-" + std::to_string(y) + "-" + std::to_string(z);
}

OctreeCube OctreeCube::around(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  constexpr double margin = 1.0 + 1e-6;  // points on the rim lie within, however a reader computes the cubes' sides
  const Eigen::Vector3d centre = 0.5 * (low + high);
  const double half = 0.5 * (high - low).maxCoeff() * margin;
  return {centre, half > 0.0 ? half : 1.0};
}

OctreeCube OctreeCube::of(const OctreeKey& key) const {
  const double half = std::ldexp(half_side, -key.level);
  return {low() + half * (2.0 * Eigen::Vector3d(key.x, key.y, key.z).array() + 1.0).matrix(), half};
}

std::uint64_t octree_code(const OctreeCube& cube, const Eigen::Vector3d& point) {
  constexpr double cells = 1u << octree::depth_bits;
  const Eigen::Vector3d at = (point - cube.low()) * (cells / cube.side());
  const auto cell = [](double v) { return static_cast<std::uint64_t>(std::clamp(std::floor(v), 0.0, cells - 1.0)); };
  return spread(cell(at.x())) | spread(cell(at.y())) << 1 | spread(cell(at.z())) << 2;
}

OctreeKey octree_key(std::uint64_t code, int level) {
  const std::uint64_t top = level == 0 ? 0 : code >> (code_bits - 3 * level);
  return {level, gathered(top), gathered(top >> 1), gathered(top >> 2)};
}

std::vector<std::uint8_t> octree_levels(std::span<const std::uint64_t> codes, std::span<const std::uint64_t> priorities) {
  // Along the curve the depth that a point shares with others falls to either side: the nearest of lower priority decide.
  const std::size_t n = codes.size();
  std::vector<std::uint8_t> levels(n);
  std::vector<std::uint32_t> lower;  // those before, of ascending priority
  const auto raise = [&](std::size_t i, std::size_t to) {
    const int level = std::clamp(shared_depth(codes[i], codes[to]) + 1 - octree::cell_bits, 0, octree::max_level);
    levels[i] = std::max(levels[i], static_cast<std::uint8_t>(level));
  };
  for (std::size_t i = 0; i < n; ++i) {
    while (!lower.empty() && priorities[lower.back()] > priorities[i]) {
      raise(lower.back(), i);
      lower.pop_back();
    }
    if (!lower.empty()) raise(i, lower.back());
    lower.push_back(static_cast<std::uint32_t>(i));
  }
  return levels;
}

void visit_octree(const OctreeKey& top, std::span<const std::uint64_t> codes, std::span<const std::uint8_t> levels, const OnNode& on_node) {
  OctreeVisit(codes, levels, on_node).visit(top, 0, codes.size());
}

}  // namespace swath::io
