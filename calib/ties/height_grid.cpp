// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/ties/height_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "core/floor_div.h"

namespace swath::calib {
namespace {

constexpr int side = HeightTile::side;
constexpr double returns_per_height = 2.0;
constexpr std::uint16_t full = std::numeric_limits<std::uint16_t>::max();

std::uint64_t tile_key(std::int32_t i, std::int32_t j) {
  return static_cast<std::uint64_t>(static_cast<std::uint32_t>(i)) << 32 | static_cast<std::uint32_t>(j);
}
std::int32_t index_of(double v, double cell) { return static_cast<std::int32_t>(std::floor(v / cell)); }

HeightTile& tile_at(HeightView& view, std::int32_t i, std::int32_t j, bool& made) {
  const auto [at, fresh] = view.number.try_emplace(tile_key(i, j), static_cast<std::uint32_t>(view.tiles.size()));
  made = fresh;
  if (fresh) {
    view.tiles.emplace_back();
    view.tiles.back().i = i, view.tiles.back().j = j;
  }
  return view.tiles[at->second];
}

// The same view on cells of twice the side.
HeightView coarser(const HeightView& fine) {
  HeightView out;
  out.line = fine.line, out.astern = fine.astern;
  for (const HeightTile& t : fine.tiles) {
    bool made = false;
    HeightTile& to =
        tile_at(out, static_cast<std::int32_t>(core::floor_div(t.i, 2)), static_cast<std::int32_t>(core::floor_div(t.j, 2)), made);
    if (made) to.base = t.base, to.time = t.time, to.sample = t.sample;
    const int left = (t.i - 2 * to.i) * side / 2, low = (t.j - 2 * to.j) * side / 2;
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        const size_t from = static_cast<size_t>(y * side + x), at = static_cast<size_t>((low + y / 2) * side + left + x / 2);
        if (t.n[from] == 0 || to.n[at] > full - t.n[from]) continue;
        to.sum[at] += t.sum[from] + static_cast<float>(t.n[from]) * (t.base - to.base);
        to.n[at] = static_cast<std::uint16_t>(to.n[at] + t.n[from]);
      }
  }
  return out;
}

}  // namespace

const HeightTile* HeightView::tile(std::int32_t i, std::int32_t j) const {
  const auto at = number.find(tile_key(i, j));
  return at == number.end() ? nullptr : &tiles[at->second];
}

Raster HeightView::raster(std::int64_t i0, std::int64_t j0, int nx, int ny, int factor) const {
  const size_t cells = static_cast<size_t>(nx) * static_cast<size_t>(ny);
  std::vector<double> sum(cells, 0.0);
  std::vector<std::uint32_t> n(cells, 0);
  const std::int64_t west = i0 * factor, south = j0 * factor, wide = std::int64_t{nx} * factor, high = std::int64_t{ny} * factor;
  for (std::int64_t tj = core::floor_div(south, side); tj <= core::floor_div(south + high - 1, side); ++tj)
    for (std::int64_t ti = core::floor_div(west, side); ti <= core::floor_div(west + wide - 1, side); ++ti) {
      const HeightTile* t = tile(static_cast<std::int32_t>(ti), static_cast<std::int32_t>(tj));
      if (!t) continue;
      for (int y = 0; y < side; ++y) {
        const std::int64_t row = tj * side + y - south;
        if (row < 0 || row >= high) continue;
        for (int x = 0; x < side; ++x) {
          const std::int64_t column = ti * side + x - west;
          const size_t from = static_cast<size_t>(y * side + x);
          if (column < 0 || column >= wide || t->n[from] == 0) continue;
          const size_t at = static_cast<size_t>(row / factor * nx + column / factor);
          sum[at] += static_cast<double>(t->sum[from]) + static_cast<double>(t->n[from]) * static_cast<double>(t->base);
          n[at] += t->n[from];
        }
      }
    }
  Raster out{nx, ny, std::vector<float>(cells, std::numeric_limits<float>::quiet_NaN())};
  for (size_t c = 0; c < cells; ++c)
    if (n[c] > 0) out.z[c] = static_cast<float>(sum[c] / n[c]);
  return out;
}

HeightGrids height_grids(const ShotStream& stream, LocalPoints& points, double smallest_cell, std::uint64_t most_cells) {
  HeightGrids out;
  const bool turns = !points.geometry().beam().is_across();
  std::map<std::pair<int, bool>, size_t> view_of;
  std::uint64_t tiles = 0;
  const std::uint64_t most_tiles = std::max<std::uint64_t>(most_cells / (side * side), 1);
  const auto begin = [&](double density) {
    out.cell = density > 0.0 ? std::max(smallest_cell, std::sqrt(returns_per_height / density)) : smallest_cell;
  };
  stream_points(stream, points, begin, [&](int line, const core::Shots& shots, const PointColumns& p) {
    HeightView* of[2] = {nullptr, nullptr};
    HeightTile* last = nullptr;
    const HeightView* last_view = nullptr;
    for (size_t r = 0; r < shots.size(); ++r) {
      if (std::isnan(p.x[r]) || !is_last_return(shots, r)) continue;
      const bool astern = turns && std::cos(points.geometry().angle(shots.angle[r])) < 0.0;
      HeightView*& view = of[astern ? 1 : 0];
      if (!view) {
        const auto [at, fresh] = view_of.try_emplace({line, astern}, out.views.size());
        if (fresh) {
          out.views.emplace_back();
          out.views.back().line = line, out.views.back().astern = astern;
          of[astern ? 0 : 1] = nullptr;  // may have moved
          last = nullptr;
        }
        view = &out.views[at->second];
      }
      const std::int32_t i = index_of(p.x[r], out.cell), j = index_of(p.y[r], out.cell);
      const auto ti = static_cast<std::int32_t>(core::floor_div(i, side)), tj = static_cast<std::int32_t>(core::floor_div(j, side));
      if (!last || view != last_view || last->i != ti || last->j != tj) {
        bool made = false;
        last = &tile_at(*view, ti, tj, made);
        last_view = view;
        if (made) {
          last->base = static_cast<float>(p.z[r]);
          last->time = shots.time[r];
          last->sample = {shots.angle[r], shots.forward.empty() ? 0.0 : shots.forward[r], shots.range[r]};
          ++tiles;
        }
      }
      const size_t at = static_cast<size_t>((j - tj * side) * side + (i - ti * side));
      ++out.returns;
      if (last->n[at] < full) {
        ++last->n[at];
        last->sum[at] += static_cast<float>(p.z[r]) - last->base;
      }
      if (tiles > most_tiles) {
        out.cell *= 2.0;
        tiles = 0;
        for (HeightView& v : out.views) {
          v = coarser(v);
          tiles += v.tiles.size();
        }
        last = nullptr;
      }
    }
  });
  return out;
}

}  // namespace swath::calib
