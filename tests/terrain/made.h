// SPDX-License-Identifier: GPL-3.0-or-later
// Made points and grids for the tests of this room.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <numeric>
#include <random>
#include <vector>

#include "core/block.h"
#include "core/grid.h"

namespace swath::test {

using Surface = std::function<double(double, double)>;

/// A Block of ground points with sigma columns and a map origin like that of a UTM zone.
struct Made {
  core::Block block;
  Made() { block.origin = {500000.0, 4600000.0, 0.0}; }
  void add(double x, double y, double z, float sigma_v = 0.03f, std::uint8_t point_class = core::point_class::ground) {
    core::resize(block, block.size() + 1);
    core::add_columns(block, {core::Column::classification, core::Column::sigma_v, core::Column::sigma_h, core::Column::return_number});
    block.x.back() = x;
    block.y.back() = y;
    block.z.back() = z;
    block.sigma_v.back() = sigma_v;
    block.sigma_h.back() = 0.1f;
    block.classification.back() = point_class;
    block.return_number.back() = 1;
  }
};

inline core::Block random_points(size_t n, double side, const Surface& surface, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(0.0, side);
  Made m;
  for (size_t i = 0; i < n; ++i) {
    const double x = place(random), y = place(random);
    m.add(x, y, surface(x, y), static_cast<float>(0.01 + 0.05 * place(random) / side));
  }
  return m.block;
}

/// Points on the whole metres: every square of four is cocircular.
inline core::Block lattice_points(int side, const Surface& surface) {
  Made m;
  for (int j = 0; j <= side; ++j)
    for (int i = 0; i <= side; ++i) m.add(i, j, surface(i, j));
  return m.block;
}

/// Coordinates rounded to `step`, as LAS files hold them: duplicates and cocircular points come by themselves.
inline core::Block quantised(core::Block b, double step) {
  for (auto* c : {&b.x, &b.y, &b.z})
    for (double& v : *c) v = std::round(v / step) * step;
  return b;
}

inline std::vector<std::uint32_t> all_rows(const core::Block& b) {
  std::vector<std::uint32_t> rows(b.size());
  std::iota(rows.begin(), rows.end(), 0u);
  return rows;
}

/// The points within `halo` of a window, in an order of their own.
inline core::Block near_window(const core::Block& b, const core::Lattice& w, double halo, unsigned seed) {
  std::vector<std::uint32_t> rows;
  for (size_t i = 0; i < b.size(); ++i) {
    const double x = b.x[i] + b.origin.x(), y = b.y[i] + b.origin.y();
    if (x >= w.west() - halo && x <= w.east() + halo && y >= w.south() - halo && y <= w.north() + halo)
      rows.push_back(static_cast<std::uint32_t>(i));
  }
  std::shuffle(rows.begin(), rows.end(), std::mt19937(seed));
  return core::select(b, rows);
}

/// The whole lattice cut into tiles of `cells`, each computed from its own points and halo, laid together.
inline core::Grid tiled(const core::Block& b, const core::Lattice& all, int cells, double halo,
                        const std::function<core::Grid(const core::Block&, const core::Lattice&)>& make) {
  core::Grid out(all);
  out.count.assign(all.size(), 0);
  out.sigma.assign(all.size(), std::numeric_limits<float>::quiet_NaN());
  for (int tj = 0; tj < all.ny; tj += cells)
    for (int ti = 0; ti < all.nx; ti += cells) {
      const core::Lattice w{all.cell, all.i0 + ti, all.j0 + tj, std::min(cells, all.nx - ti), std::min(cells, all.ny - tj)};
      const core::Grid tile = make(near_window(b, w, halo, static_cast<unsigned>(ti * 7919 + tj)), w);
      for (int j = 0; j < w.ny; ++j)
        for (int i = 0; i < w.nx; ++i) {
          const size_t to = all.at(ti + i, tj + j), from = w.at(i, j);
          out.height[to] = tile.height[from];
          out.reason[to] = tile.reason[from];
          if (!tile.count.empty()) out.count[to] = tile.count[from];
          if (!tile.sigma.empty()) out.sigma[to] = tile.sigma[from];
        }
    }
  return out;
}

/// Equal bit for bit, NaN included.
template <class T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

inline core::Grid sampled(const core::Lattice& l, const Surface& surface) {
  core::Grid g(l);
  for (int j = 0; j < l.ny; ++j)
    for (int i = 0; i < l.nx; ++i) {
      g.height[l.at(i, j)] = static_cast<float>(surface(l.centre_x(i), l.centre_y(j)));
      g.reason[l.at(i, j)] = core::Void::none;
    }
  return g;
}

}  // namespace swath::test
