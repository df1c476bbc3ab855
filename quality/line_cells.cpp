// SPDX-License-Identifier: GPL-3.0-or-later
// A plane by least squares through the single returns of each line in each cell; where two lines have one that fits, they are compared at
// the cell's centre. Steep cells are compared apart, for there an error of place passes for one of height, and by the side to which they
// fall, for on opposite sides it has opposite signs. A cell's rms is divided by quartile_of() its degrees of freedom.
// Returns are summed in an order that their coordinates alone decide, so that tiles that share a block agree to the last bit.
#include "quality/line_cells.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <span>
#include <tuple>

#include "core/distributions.h"
#include "core/grid.h"
#include "core/statistics.h"
#include "quality/cell_planes.h"

namespace swath::quality {
namespace {

constexpr int block_side = 16;  // narrowest cells
constexpr size_t cells_of_block = size_t{block_side} * block_side;
constexpr double steep = 0.35;     // rise / run: level ground up to this
constexpr size_t least_cells = 3;  // of a block

struct BlockKey {
  std::int64_t i, j;
  auto operator<=>(const BlockKey&) const = default;
};

struct Moments {
  std::uint16_t cell, line;
  PlaneSums sums{};
};

int aspect_of(const CellPlane& p) {
  if (p.slope_squared() <= steep * steep) return 0;
  if (std::abs(p.east) >= std::abs(p.north)) return p.east < 0.0 ? 1 : 3;
  return p.north < 0.0 ? 2 : 4;
}

/// The blocks that hold one of the first `own` points, rising.
template <class BlockOf>
std::vector<BlockKey> blocks_of(const core::Block& b, size_t own, BlockOf&& block_of) {
  std::vector<BlockKey> blocks;
  for (size_t p = 0; p < own; ++p)
    if (is_single(b, p))
      if (const BlockKey key = block_of(p); blocks.empty() || blocks.back() != key) blocks.push_back(key);
  std::sort(blocks.begin(), blocks.end());
  blocks.erase(std::unique(blocks.begin(), blocks.end()), blocks.end());
  return blocks;
}

/// The returns of such blocks; a block's cells follow one another. x, y from the block's centre.
ReturnsByCell returns_in_blocks(const core::Block& b, size_t own, double cell, std::vector<BlockKey>& blocks) {
  const double side = cell * block_side;
  const auto block_of = [&](size_t p) {
    return BlockKey{core::cell_index(b.origin.x() + b.x[p], side), core::cell_index(b.origin.y() + b.y[p], side)};
  };
  blocks = blocks_of(b, own, block_of);
  const auto east = [&](size_t p, const BlockKey& key) { return b.origin.x() + b.x[p] - static_cast<double>(key.i) * side; };
  const auto north = [&](size_t p, const BlockKey& key) { return b.origin.y() + b.y[p] - static_cast<double>(key.j) * side; };
  size_t last = 0;
  const auto cell_of = [&](size_t p) {
    if (!is_single(b, p)) return no_cell;
    const BlockKey key = block_of(p);
    if (last >= blocks.size() || blocks[last] != key)
      last = static_cast<size_t>(std::lower_bound(blocks.begin(), blocks.end(), key) - blocks.begin());
    if (last >= blocks.size() || blocks[last] != key) return no_cell;
    const auto place = [cell](double v) { return std::clamp(static_cast<int>(v / cell), 0, block_side - 1); };
    return static_cast<std::uint32_t>(last * cells_of_block) +
           static_cast<std::uint32_t>(place(north(p, key)) * block_side + place(east(p, key)));
  };
  const auto return_of = [&](size_t p) {
    const BlockKey key = block_of(p);
    return CellReturn{east(p, key) - 0.5 * side, north(p, key) - 0.5 * side, b.z[p], 0.0F, b.strip.empty() ? std::uint16_t{0} : b.strip[p]};
  };
  return {b.size(), blocks.size() * cells_of_block, cell_of, return_of};
}

std::vector<Moments> moments_of(const ReturnsByCell& returns, size_t block) {
  std::vector<Moments> out;
  for (std::uint16_t cell = 0; cell < cells_of_block; ++cell)
    for (const CellReturn& r : returns.in(block * cells_of_block + cell)) {
      if (out.empty() || out.back().cell != cell || out.back().line != r.line) out.push_back({cell, r.line});
      out.back().sums.add(r.x, r.y, r.z);
    }
  return out;
}

/// Cells of twice the side, `across` of them before.
std::vector<Moments> doubled(std::vector<Moments> cells, int across) {
  for (Moments& m : cells) m.cell = static_cast<std::uint16_t>(m.cell / across / 2 * (across / 2) + m.cell % across / 2);
  const auto key = [](const Moments& m) { return std::tuple(m.cell, m.line); };
  std::stable_sort(cells.begin(), cells.end(), [&key](const Moments& a, const Moments& b) { return key(a) < key(b); });
  std::vector<Moments> out;
  for (const Moments& m : cells)
    if (!out.empty() && key(out.back()) == key(m))
      out.back().sums.add(m.sums);
    else
      out.push_back(m);
  return out;
}

/// Differences and scatters of one block on one level.
class BlockAtLevel {
 public:
  BlockAtLevel(const LineOptions& o, double cell, int across) : options_(o), cell_(cell), across_(across) {}

  void see(const std::vector<Moments>& moments) {
    for (size_t begin = 0, end = 0; begin < moments.size(); begin = end) {
      while (end < moments.size() && moments[end].cell == moments[begin].cell) ++end;
      see_cell({moments.data() + begin, end - begin});
    }
  }

  void give(LineCells& out, std::int32_t level, const BlockKey& key) const {
    const auto i = static_cast<std::int32_t>(key.i), j = static_cast<std::int32_t>(key.j);
    for (const auto& [line, all] : sigmas_) {
      const std::vector<double>& sigmas = all[0].size() >= least_cells ? all[0] : all[1];
      if (sigmas.size() >= least_cells)
        out.scatters.push_back(
            {level, i, j, line, static_cast<std::uint32_t>(sigmas.size()), static_cast<float>(core::quantile(sigmas, 0.25))});
    }
    for (const auto& [pair, compared] : compared_) {
      const auto& [a, b, aspect] = pair;
      if (compared.differences.size() < least_cells) continue;
      const auto count = static_cast<std::uint32_t>(compared.differences.size());
      const double middle = core::middle(compared.differences);
      std::vector<double> apart;
      for (const double d : compared.differences) apart.push_back(std::abs(d - middle));
      out.differences.push_back({level, i, j, a, b, count, static_cast<float>(middle),
                                 static_cast<float>(core::mad_to_sigma * core::median(apart)),
                                 static_cast<float>(std::sqrt(compared.slopes_squared / count)), aspect});
    }
  }

 private:
  void see_cell(std::span<const Moments> lines) {
    const double middle = 0.5 * cell_ * across_;
    const double cx = (lines[0].cell % across_ + 0.5) * cell_ - middle, cy = (lines[0].cell / across_ + 0.5) * cell_ - middle;
    smooth_.clear();
    for (const Moments& m : lines) {
      if (m.sums.n < options_.least) continue;
      const std::optional<CellPlane> plane = plane_of(m.sums, cx, cy, cell_);
      if (!plane || plane->rms > options_.roughness.value) continue;
      sigmas_[m.line][aspect_of(*plane) == 0 ? 0 : 1].push_back(plane->rms / quartile_of(m.sums.n - 3.0));
      smooth_.emplace_back(m.line, *plane);
    }
    for (size_t a = 0; a < smooth_.size(); ++a)
      for (size_t b = a + 1; b < smooth_.size(); ++b) {
        const CellPlane &p = smooth_[a].second, &q = smooth_[b].second;
        const CellPlane mean{0.0, 0.0, 0.5 * (p.east + q.east), 0.5 * (p.north + q.north)};
        Compared& of_pair = compared_[{smooth_[a].first, smooth_[b].first, aspect_of(mean)}];
        of_pair.differences.push_back(p.height - q.height);
        of_pair.slopes_squared += mean.slope_squared();
      }
  }

  const LineOptions& options_;
  double cell_;
  int across_;
  std::map<int, std::array<std::vector<double>, 2>> sigmas_;  ///< by line: on level ground, on steep ground
  struct Compared {
    std::vector<double> differences;
    double slopes_squared = 0.0;
  };
  std::map<std::tuple<int, int, int>, Compared> compared_;  ///< by lines and aspect
  std::vector<std::pair<int, CellPlane>> smooth_;
};

}  // namespace

std::vector<double> cell_sides(const LineOptions& o) {
  if (o.cell) return {o.cell->value};
  return {2.0, 4.0, 8.0};
}

double halo(const LineOptions& o) { return block_side * cell_sides(o).front(); }

LineCells compare_cells(const core::Block& b, size_t own, const LineOptions& o) {
  const std::vector<double> sides = cell_sides(o);
  std::vector<BlockKey> blocks;
  const ReturnsByCell returns = returns_in_blocks(b, own, sides.front(), blocks);
  LineCells out;
  for (size_t block = 0; block < blocks.size(); ++block) {
    std::vector<Moments> moments = moments_of(returns, block);
    int across = block_side;
    for (size_t level = 0; level < sides.size(); ++level, across /= 2) {
      if (level > 0) moments = doubled(std::move(moments), 2 * across);
      BlockAtLevel judge(o, sides[level], across);
      judge.see(moments);
      judge.give(out, static_cast<std::int32_t>(level), blocks[block]);
    }
  }
  return out;
}

}  // namespace swath::quality
