// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/classes/wire_sieve.h"

#include <algorithm>
#include <cmath>

#include "filters/bins.h"

namespace swath::filters {
namespace {

constexpr int ring = 3;             // columns around
constexpr int most_columns = 32;    // of 49
constexpr std::int32_t levels = 1;  // above and below

/// Levels of voxels that hold points, by columns.
class Voxels {
 public:
  Voxels(const core::Block& b, double side, const std::vector<std::uint8_t>& candidate, const std::vector<std::uint8_t>& surface)
      : side_(side), lattice_(lattice_around(b, side, ring)), start_(lattice_.size() + 1, 0) {
    const auto counts = [&](size_t p) { return candidate[p] || surface[p]; };
    for (size_t p = 0; p < b.size(); ++p)
      if (counts(p)) ++start_[column_of(b, p) + 1];
    for (size_t c = 1; c < start_.size(); ++c) start_[c] += start_[c - 1];
    level_.resize(start_.back());
    std::vector<std::uint32_t> next(start_.begin(), start_.end() - 1);
    for (size_t p = 0; p < b.size(); ++p)
      if (counts(p)) level_[next[column_of(b, p)]++] = level_of(b, p);
    end_.resize(lattice_.size());
    for (size_t c = 0; c < end_.size(); ++c) {
      const auto first = level_.begin() + start_[c], last = level_.begin() + start_[c + 1];
      std::sort(first, last);
      end_[c] = static_cast<std::uint32_t>(std::unique(first, last) - level_.begin());
    }
    verdict_.assign(level_.size(), unknown);
  }

  bool is_airy(const core::Block& b, size_t p) {
    const size_t c = column_of(b, p);
    const std::int32_t k = level_of(b, p);
    const auto voxel = static_cast<size_t>(std::lower_bound(level_.begin() + start_[c], level_.begin() + end_[c], k) - level_.begin());
    if (verdict_[voxel] == unknown) verdict_[voxel] = few_columns(c, k);
    return verdict_[voxel] != 0;
  }

 private:
  static constexpr std::uint8_t unknown = 2;

  size_t column_of(const core::Block& b, size_t p) const {
    const CellIndex c = cell_of(lattice_, b, p);
    return lattice_.at(c.i, c.j);
  }
  std::int32_t level_of(const core::Block& b, size_t p) const {
    return static_cast<std::int32_t>(std::clamp(std::floor((b.origin.z() + b.z[p]) / side_), -1e9, 1e9));
  }

  bool few_columns(size_t c, std::int32_t k) const {
    int n = 0;
    for (std::ptrdiff_t dj = -ring; dj <= ring; ++dj)
      for (std::ptrdiff_t di = -ring; di <= ring; ++di) {
        const auto at = static_cast<size_t>(static_cast<std::ptrdiff_t>(c) + dj * lattice_.nx + di);
        for (std::uint32_t v = start_[at]; v < end_[at] && level_[v] <= k + levels; ++v)
          if (level_[v] >= k - levels) {
            ++n;
            break;
          }
      }
    return n <= most_columns;
  }

  double side_;
  core::Lattice lattice_;
  std::vector<std::uint32_t> start_, end_;  // per column, of level_
  std::vector<std::int32_t> level_;         // ascending in each column
  std::vector<std::uint8_t> verdict_;       // per voxel
};

}  // namespace

double airy_points_halo() { return Districts::halo() + (ring + 1) * sample_sides.back(); }

std::vector<std::uint8_t> airy_points(const core::Block& b, const std::vector<std::uint8_t>& candidate,
                                      const std::vector<std::uint8_t>& surface, const Districts& where) {
  std::vector<std::uint8_t> out(b.size(), 0);
  for (size_t kind = 0; kind < sample_sides.size(); ++kind) {
    if (std::find(where.side.begin(), where.side.end(), kind) == where.side.end()) continue;
    Voxels voxels(b, sample_sides[kind], candidate, surface);
    for (size_t p = 0; p < b.size(); ++p) {
      if (!candidate[p]) continue;
      const CellIndex d = cell_of(where.lattice, b, p);
      if (where.side[where.lattice.at(d.i, d.j)] == kind) out[p] = voxels.is_airy(b, p);
    }
  }
  return out;
}

}  // namespace swath::filters
