// SPDX-License-Identifier: GPL-3.0-or-later
// Occupancy by ray casting: Hornung, Wurm, Bennewitz, Stachniss & Burgard 2013, "OctoMap: an efficient probabilistic 3D mapping framework
// based on octrees", Autonomous Robots 34 (its octree, and its traversal after Amanatides & Woo 1987). Gap fraction of a layer as passages
// over entries: Hosoi & Omasa 2006, "Voxel-based 3-D modeling of individual trees", IEEE TGRS 44.
//
// Deviations.
// - Voxels hold counts (beams that passed, returns of the ground, other returns) in place of a clamped log-odds: the share of beams that
//   ended is wanted, not a belief.
// - A beam is followed over the last `reach` of its way, or from the pulse's return before. It is taken as straight on the map: over 100 m
//   the Earth's curvature bends it there by less than 0.1 mm.
// - A beam that crosses a voxel's corner counts as one that crosses its middle.
// - Voxels lie on whole multiples of their side in map coordinates; each beam is traced in a frame that begins at its own return's
//   voxel, in single precision (1 um per 10 m), so that neither tiles nor the size of a survey change its voxels.
#include "filters/noise/visibility.h"

#include <octomap/AbstractOcTree.h>
#include <octomap/OcTreeBaseImpl.h>
#include <octomap/OcTreeDataNode.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "core/error.h"
#include "core/statistics.h"

namespace swath::filters {
namespace {

using Eigen::Vector3d;
using Voxel = std::array<std::int64_t, 3>;

constexpr int most_layers = 24;
constexpr std::int64_t key_middle = 32768, key_reach = 30000;  // OctoMap's keys have 16 bits
constexpr unsigned depth = 16;
constexpr double leaf_bytes = 46.0;    // a leaf with its share of inner nodes
constexpr double column_height = 1.3;  // of the reach: returns of one column lie at several heights

struct Counts {
  std::uint32_t passed = 0;
  std::uint16_t ground = 0, other = 0;
  bool operator==(const Counts&) const = default;
};

void raise(std::uint16_t& n) { n = static_cast<std::uint16_t>(n + (n < 0xffff)); }

class Node : public octomap::OcTreeDataNode<Counts> {
 public:
  Node() : OcTreeDataNode(Counts{}) {}
  Counts& counts() { return value; }
  const Counts& counts() const { return value; }
};

/// An octree of counts, its keys relative to a voxel in the tile's middle.
class Space : public octomap::OcTreeBaseImpl<Node, octomap::AbstractOcTree> {
 public:
  Space(double voxel, const Voxel& middle) : OcTreeBaseImpl(voxel), middle_(middle) {
    root = new Node();
    ++tree_size;
    path_.fill(nullptr);
    path_[0] = root;
  }

  Space* create() const override { return new Space(resolution, middle_); }
  std::string getTreeType() const override { return "Space"; }

  const Voxel& middle() const { return middle_; }
  bool is_empty() const { return !nodeHasChildren(root); }
  octomap::OcTreeKey key_of(const Voxel& v) const {
    const auto part = [&](size_t a) { return static_cast<octomap::key_type>(v[a] - middle_[a] + key_middle); };
    return {part(0), part(1), part(2)};
  }
  Voxel voxel_of(const octomap::OcTreeKey& k) const {
    return {k[0] - key_middle + middle_[0], k[1] - key_middle + middle_[1], k[2] - key_middle + middle_[2]};
  }

  /// The voxel's leaf, made where it is missing. The way from the root is shared with the leaf asked for before.
  Counts& at(const octomap::OcTreeKey& key) {
    unsigned level = 0;
    if (path_[depth]) {
      unsigned differ = (key[0] ^ last_[0]) | (key[1] ^ last_[1]) | (key[2] ^ last_[2]);
      for (level = depth; differ != 0; differ >>= 1) --level;
    }
    for (; level < depth; ++level) {
      const unsigned child = octomap::computeChildIdx(key, static_cast<int>(depth - 1 - level));
      path_[level + 1] = nodeChildExists(path_[level], child) ? getNodeChild(path_[level], child) : createNodeChild(path_[level], child);
    }
    last_ = key;
    return path_[depth]->counts();
  }

  const Counts* find(const Voxel& v) const {
    for (size_t a = 0; a < 3; ++a)
      if (std::abs(v[a] - middle_[a]) > key_reach) return nullptr;
    const Node* node = search(key_of(v), depth);
    return node ? &node->counts() : nullptr;
  }

 private:
  Voxel middle_;
  std::array<Node*, depth + 1> path_{};
  octomap::OcTreeKey last_;
};

Vector3d place(const core::Block& b, size_t p) { return {b.x[p], b.y[p], b.z[p]}; }

Voxel voxel_at(const core::Block& b, const Vector3d& at, double side) {
  return {core::cell_index(b.origin.x() + at.x(), side), core::cell_index(b.origin.y() + at.y(), side),
          core::cell_index(b.origin.z() + at.z(), side)};
}

/// Voxel columns [i0, i1] x [j0, j1] whose counts are wanted.
struct Region {
  std::int64_t i0 = std::numeric_limits<std::int64_t>::max(), i1 = std::numeric_limits<std::int64_t>::min(), j0 = i0, j1 = i1;
  bool holds(std::int64_t i, std::int64_t j) const { return i >= i0 && i <= i1 && j >= j0 && j <= j1; }
  void take_in(std::int64_t i, std::int64_t j) {
    i0 = std::min(i0, i), i1 = std::max(i1, i);
    j0 = std::min(j0, j), j1 = std::max(j1, j);
  }
  bool met_by(const Voxel& a, const Voxel& b) const {
    return std::max(a[0], b[0]) >= i0 && std::min(a[0], b[0]) <= i1 && std::max(a[1], b[1]) >= j0 && std::min(a[1], b[1]) <= j1;
  }
};

Region region_of(const core::Block& b, size_t own, const core::Lattice& l, double side) {
  Region r;
  for (size_t p = 0; p < own; ++p) r.take_in(core::cell_index(b.origin.x() + b.x[p], side), core::cell_index(b.origin.y() + b.y[p], side));
  --r.i0, --r.j0, ++r.i1, ++r.j1;
  if (l.size() > 0) {
    r.take_in(core::cell_index(l.west(), side), core::cell_index(l.south(), side));
    r.take_in(core::cell_index(l.east(), side), core::cell_index(l.north(), side));
  }
  return r;
}

/// Usable points with the returns of each pulse one after the other, the first first.
std::vector<std::uint32_t> pulses_in_order(const core::Block& b, const std::vector<Vector3d>& scanner) {
  std::vector<std::uint32_t> rows;
  std::vector<float> range(b.size(), 0.0f);
  for (std::uint32_t p = 0; p < b.size(); ++p) {
    if (!core::is_usable(b, p)) continue;
    rows.push_back(p);
    if (scanner[p].allFinite()) range[p] = static_cast<float>((scanner[p] - place(b, p)).norm());
  }
  std::sort(rows.begin(), rows.end(), [&](std::uint32_t p, std::uint32_t q) {
    if (b.time[p] != b.time[q]) return b.time[p] < b.time[q];
    if (!b.strip.empty() && b.strip[p] != b.strip[q]) return b.strip[p] < b.strip[q];
    return range[p] < range[q];
  });
  return rows;
}

bool same_pulse(const core::Block& b, size_t p, size_t q) {
  return b.time[p] == b.time[q] && (b.strip.empty() || b.strip[p] == b.strip[q]);
}

/// Counts the voxels between a return and the place where its beam is taken up, the return's own left out.
void follow(Space& space, octomap::KeyRay& ray, const core::Block& b, size_t p, const Vector3d& scanner, const Vector3d* before,
            const Region& region, double side, double reach) {
  const Vector3d end = place(b, p);
  const Vector3d from = before ? *before : scanner;
  const double way = (from - end).norm();
  if (!(way > 0.0)) return;
  const double length = std::min(reach, way);
  const Vector3d start = end + (from - end) * (length / way);
  const Voxel home = voxel_at(b, end, side);
  const Voxel first = voxel_at(b, start, side);
  if (!region.met_by(home, first)) return;

  octomap::point3d local_end, local_start;
  for (unsigned a = 0; a < 3; ++a) {
    const auto i = static_cast<Eigen::Index>(a);
    const double corner = static_cast<double>(home[a]) * side - b.origin[i];
    local_end(a) = static_cast<float>(std::clamp(end[i] - corner, 1e-6 * side, (1.0 - 1e-6) * side));
    local_start(a) = static_cast<float>(start[i] - corner);
  }
  if (!space.computeRayKeys(local_start, local_end, ray)) return;
  const bool starts_at_return = before && length == way;
  for (const octomap::OcTreeKey& k : ray) {
    const Voxel v{home[0] + k[0] - key_middle, home[1] + k[1] - key_middle, home[2] + k[2] - key_middle};
    if (!region.holds(v[0], v[1]) || (starts_at_return && v == first)) continue;
    ++space.at(space.key_of(v)).passed;
  }
}

void fill(Space& space, const core::Block& b, const std::vector<Vector3d>& scanner, const Region& region, const VisibilityOptions& o) {
  const double side = o.voxel.value;
  octomap::KeyRay ray;
  const std::vector<std::uint32_t> rows = pulses_in_order(b, scanner);
  for (size_t n = 0; n < rows.size(); ++n) {
    const std::uint32_t p = rows[n];
    const Vector3d at = place(b, p);
    const Voxel home = voxel_at(b, at, side);
    // Neither the return nor what lies within reach of it may leave the octree's keys.
    if (std::abs(home[2] - space.middle()[2]) > key_reach - static_cast<std::int64_t>(o.reach / o.voxel) - 2) continue;
    if (region.holds(home[0], home[1])) {
      Counts& c = space.at(space.key_of(home));
      raise(!b.classification.empty() && b.classification[p] == core::point_class::ground ? c.ground : c.other);
    }
    if (!scanner[p].allFinite()) continue;
    const bool follows = n > 0 && same_pulse(b, rows[n - 1], p);
    const Vector3d before = follows ? place(b, rows[n - 1]) : at;
    follow(space, ray, b, p, scanner[p], follows ? &before : nullptr, region, side, o.reach.value);
  }
}

/// Did so few of the beams that entered the voxel and those around it end there that what they met is noise?
bool is_passed(const Space& space, const Voxel& v, const VisibilityOptions& o) {
  std::uint64_t passed = 0, met = 0;
  for (std::int64_t dz = -1; dz <= 1; ++dz)
    for (std::int64_t dy = -1; dy <= 1; ++dy)
      for (std::int64_t dx = -1; dx <= 1; ++dx)
        if (const Counts* c = space.find({v[0] + dx, v[1] + dy, v[2] + dz})) {
          passed += c->passed;
          met += static_cast<std::uint64_t>(c->ground) + c->other;
        }
  return met <= static_cast<std::uint64_t>(o.group) && static_cast<double>(met) < o.solid * static_cast<double>(met + passed);
}

/// Pulses by cell, and the voxel of each cell's lowest ground return.
std::vector<std::int64_t> count_pulses(const core::Block& b, double side, Visibility& out) {
  const core::Lattice& l = out.lattice;
  std::vector<std::int64_t> floor(l.size(), std::numeric_limits<std::int64_t>::max());
  for (size_t p = 0; p < b.size(); ++p) {
    if (!core::is_usable(b, p)) continue;
    const std::int64_t i = core::cell_index(b.origin.x() + b.x[p], l.cell) - l.i0,
                       j = core::cell_index(b.origin.y() + b.y[p], l.cell) - l.j0;
    if (i < 0 || j < 0 || i >= l.nx || j >= l.ny) continue;
    const size_t c = l.at(static_cast<int>(i), static_cast<int>(j));
    out.entered[c] = 1;
    const bool ground = !b.classification.empty() && b.classification[p] == core::point_class::ground;
    if (ground) floor[c] = std::min(floor[c], core::cell_index(b.origin.z() + b.z[p], side));
    if (!core::is_last_return(b, p)) continue;
    ++out.pulses[c];
    out.ground_pulses[c] += ground;
  }
  return floor;
}

void count_layers(const Space& space, const std::vector<std::int64_t>& floor, double side, Visibility& out) {
  const core::Lattice& l = out.lattice;
  if (space.is_empty()) return;
  for (auto leaf = space.begin_leafs(); leaf != space.end_leafs(); ++leaf) {
    const Voxel v = space.voxel_of(leaf.getKey());
    const std::int64_t i = core::cell_index((static_cast<double>(v[0]) + 0.5) * side, l.cell) - l.i0;
    const std::int64_t j = core::cell_index((static_cast<double>(v[1]) + 0.5) * side, l.cell) - l.j0;
    if (i < 0 || j < 0 || i >= l.nx || j >= l.ny) continue;
    const size_t c = l.at(static_cast<int>(i), static_cast<int>(j));
    out.entered[c] = 1;
    const std::int64_t layer = v[2] - floor[c];
    if (floor[c] == std::numeric_limits<std::int64_t>::max() || layer < 0 || layer >= out.layers) continue;
    const size_t at = c * static_cast<size_t>(out.layers) + static_cast<size_t>(layer);
    out.passed[at] += leaf->counts().passed;
    out.met[at] += leaf->counts().other;
  }
}

}  // namespace

double Visibility::penetration(size_t cell) const {
  return pulses[cell] == 0 ? std::numeric_limits<double>::quiet_NaN() : static_cast<double>(ground_pulses[cell]) / pulses[cell];
}

double Visibility::gap(size_t cell, int layer) const {
  const size_t at = cell * static_cast<size_t>(layers) + static_cast<size_t>(layer);
  const std::uint64_t entries = passed[at] + met[at];
  return entries == 0 ? std::numeric_limits<double>::quiet_NaN() : static_cast<double>(passed[at]) / static_cast<double>(entries);
}

double Visibility::gap_fraction(size_t cell) const {
  double product = std::numeric_limits<double>::quiet_NaN();
  for (int layer = 1; layer < layers; ++layer) {
    const double g = gap(cell, layer);
    if (!std::isnan(g)) product = std::isnan(product) ? g : product * g;
  }
  return product;
}

core::Grid Visibility::seen() const {
  core::Grid grid(lattice);
  for (size_t c = 0; c < lattice.size(); ++c) {
    if (ground_pulses[c] > 0) {
      grid.height[c] = static_cast<float>(penetration(c));
      grid.reason[c] = core::Void::none;
    } else if (entered[c]) {
      grid.reason[c] = core::Void::never_seen;
    }
  }
  return grid;
}

double halo(const VisibilityOptions& o) { return o.reach.value + std::max(2.0 * o.voxel.value, o.cell.value + o.voxel.value); }

double visibility_bytes_per_column(const VisibilityOptions& o) { return column_height * leaf_bytes * o.reach / o.voxel; }

// A beam makes no more voxels than it passes: 1.5 per voxel of its length.
double visibility_columns_per_point() { return 1.5 / column_height; }

VisibilityCounts trace_visibility(core::Block& b, size_t own, const std::vector<Vector3d>& scanner, const core::Lattice& lattice,
                                  const VisibilityOptions& o, Visibility& out) {
  VisibilityCounts n;
  core::add_columns(b, {core::Column::classification, core::Column::flags});
  const double side = o.voxel.value;
  out = {};
  out.lattice = lattice;
  out.layers = std::min(most_layers, static_cast<int>(std::ceil(o.reach / o.voxel)));
  out.pulses.assign(lattice.size(), 0);
  out.ground_pulses.assign(lattice.size(), 0);
  out.entered.assign(lattice.size(), 0);
  out.passed.assign(lattice.size() * static_cast<size_t>(out.layers), 0);
  out.met.assign(out.passed.size(), 0);
  if (b.size() == 0) return n;

  const Region region = region_of(b, own, lattice, side);
  const Voxel middle{(region.i0 + region.i1) / 2, (region.j0 + region.j1) / 2, core::cell_index(b.origin.z() + core::median(b.z), side)};
  if (std::max(region.i1 - region.i0, region.j1 - region.j0) > 2 * key_reach)
    throw core::Error("the tile holds more than " + std::to_string(2 * key_reach) + " voxels along its side", "filters.visibility: voxel",
                      "choose larger voxels or smaller tiles");

  Space space(side, middle);
  fill(space, b, scanner, region, o);
  const std::vector<std::int64_t> floor = count_pulses(b, side, out);
  count_layers(space, floor, side, out);

  std::vector<std::uint32_t> noise;
  std::unordered_map<std::uint64_t, bool> verdicts;  // by voxel: the points of one share theirs
  for (size_t p = 0; p < own; ++p) {
    n.no_position += !scanner[p].allFinite();
    if (!core::is_usable(b, p)) {
      ++n.untouched;
      continue;
    }
    if (o.solid <= 0.0) continue;
    const Voxel v = voxel_at(b, place(b, p), side);
    const Counts* c = space.find(v);
    if (!c || c->passed == 0) continue;
    const octomap::OcTreeKey k = space.key_of(v);
    const auto [verdict, fresh] = verdicts.try_emplace(std::uint64_t{k[0]} << 32 | std::uint64_t{k[1]} << 16 | k[2], false);
    if (fresh) verdict->second = is_passed(space, v, o);
    if (verdict->second) noise.push_back(static_cast<std::uint32_t>(p));
  }
  for (const std::uint32_t p : noise) {
    b.flags[p] = static_cast<std::uint16_t>(b.flags[p] | core::flag::isolated);
    b.classification[p] = core::point_class::high_noise;
  }
  n.noise = noise.size();
  return n;
}

}  // namespace swath::filters
