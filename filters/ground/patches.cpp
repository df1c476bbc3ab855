// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/ground/patches.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "filters/bins.h"

namespace swath::filters {
namespace {

constexpr double rounding = 1e-6;  // m: sums of map coordinates against differences of them

}  // namespace

double Patching::halo() const { return side + margin + rounding; }

void for_each_patch(const core::Block& b, size_t own, const Patching& how, const std::function<bool(size_t)>& takes_part,
                    const std::function<void(const Patch&)>& work) {
  const int reach = static_cast<int>(std::ceil(how.margin / how.side));
  const Bins bins(b, how.side, reach, takes_part);
  const core::Lattice& l = bins.lattice();
  const auto before = [&b](std::uint32_t p, std::uint32_t q) {
    return std::tie(b.x[p], b.y[p], b.z[p]) < std::tie(b.x[q], b.y[q], b.z[q]);
  };
  for (int j = reach; j < l.ny - reach; ++j)
    for (int i = reach; i < l.nx - reach; ++i) {
      const auto inside = bins.rows(i, j);
      if (std::ranges::none_of(inside, [own](std::uint32_t p) { return p < own; })) continue;
      Patch patch{static_cast<double>(l.i0 + i) * how.side, static_cast<double>(l.j0 + j) * how.side, how.side, {}};
      const double west = patch.x0 - how.margin, east = patch.x0 + how.side + how.margin;
      const double south = patch.y0 - how.margin, north = patch.y0 + how.side + how.margin;
      for (int dj = -reach; dj <= reach; ++dj)
        for (int di = -reach; di <= reach; ++di)
          for (const std::uint32_t p : bins.rows(i + di, j + dj)) {
            const double x = b.origin.x() + b.x[p], y = b.origin.y() + b.y[p];
            if (x >= west && x < east && y >= south && y < north) patch.rows.push_back(p);
          }
      std::sort(patch.rows.begin(), patch.rows.end(), before);
      work(patch);
    }
}

}  // namespace swath::filters
