// SPDX-License-Identifier: GPL-3.0-or-later
// Local linear regression with a Gaussian kernel (Cleveland & Devlin 1988, J. Am. Stat. Assoc. 83), along the rows and then along the
// columns, and twice more on what it left over (twicing: Tukey 1977): a Gaussian of sigma s alone is s^2 f'' / 2 off a curved surface f,
// and damps a wave of 60 cells by 5 %; so it damps that by 0.01 % and a wave of 12 cells by some 40 %. Every pass ends within the tolerance
// of the heights as given; later passes are finer, so that what the tolerance cuts off leaves no step. Deviation: at the rim of the data,
// where a line is fitted to one side and lies off curved ground, the change is taken by the share of the kernel that data cover.
#include "terrain/contours/contour_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

namespace swath::terrain {
namespace {

constexpr std::array<double, 3> sigmas{3.0, 2.0, 1.0};  // of the passes, cells
constexpr int turns = 3;                                // of each
constexpr double cut_off = 2.5;                         // sigmas

int radius_of(double sigma) { return static_cast<int>(std::ceil(cut_off * sigma)); }

/// Heights row by row; 0 where `known` is 0.
struct Field {
  int nx = 0, ny = 0;
  std::vector<float> value;
  std::vector<std::uint8_t> known;
  size_t at(int i, int j) const { return static_cast<size_t>(j) * static_cast<size_t>(nx) + static_cast<size_t>(i); }
};

/// Weights at 0, 1, 2 ... cells.
std::vector<double> kernel_of(double sigma) {
  std::vector<double> g(static_cast<size_t>(radius_of(sigma)) + 1);
  for (size_t k = 0; k < g.size(); ++k) g[k] = std::exp(-0.5 * std::pow(static_cast<double>(k) / sigma, 2));
  return g;
}

/// The regression at cell i of a row whose window is not all known; the cell's own height where its neighbours do not give a line. `all`:
/// sum of the kernel.
float at_rim(const float* value, const std::uint8_t* known, int n, int i, const std::vector<double>& g, double all) {
  const int r = static_cast<int>(g.size()) - 1;
  double s0 = 0.0, s1 = 0.0, s2 = 0.0, t0 = 0.0, t1 = 0.0;
  for (int k = std::max(-r, -i); k <= std::min(r, n - 1 - i); ++k) {
    if (!known[i + k]) continue;
    const double w = g[static_cast<size_t>(std::abs(k))], d = static_cast<double>(value[i + k]) - static_cast<double>(value[i]);
    s0 += w, s1 += w * k, s2 += w * k * k, t0 += w * d, t1 += w * d * k;
  }
  const double det = s0 * s2 - s1 * s1, covered = std::clamp(2.0 * s0 / all - 1.0, 0.0, 1.0);
  return det > 1e-9 ? static_cast<float>(value[i] + covered * (t0 * s2 - t1 * s1) / det) : value[i];
}

/// Along the rows. As differences from each cell's own height, so that what is level stays so to the last bit.
Field along_rows(const Field& f, const std::vector<double>& g) {
  const int r = static_cast<int>(g.size()) - 1;
  const double all = std::accumulate(g.begin() + 1, g.end(), 0.5 * g[0]) * 2.0;
  Field out = f;
  std::vector<double> sum(static_cast<size_t>(f.nx));
  std::vector<int> gaps(static_cast<size_t>(f.nx) + 1, 0);
  for (int j = 0; j < f.ny; ++j) {
    const float* value = f.value.data() + f.at(0, j);
    const std::uint8_t* known = f.known.data() + f.at(0, j);
    float* to = out.value.data() + f.at(0, j);
    for (int i = 0; i < f.nx; ++i) gaps[static_cast<size_t>(i) + 1] = gaps[static_cast<size_t>(i)] + (known[i] == 0);
    if (gaps.back() == f.nx) continue;
    std::fill(sum.begin(), sum.end(), 0.0);
    for (int k = 1; k <= r; ++k) {
      const double w = g[static_cast<size_t>(k)];
      for (int i = r; i < f.nx - r; ++i)
        sum[static_cast<size_t>(i)] += w * ((static_cast<double>(value[i - k]) - static_cast<double>(value[i])) +
                                            (static_cast<double>(value[i + k]) - static_cast<double>(value[i])));
    }
    for (int i = 0; i < f.nx; ++i) {
      if (!known[i]) continue;
      const bool whole = i >= r && i < f.nx - r && gaps[static_cast<size_t>(i + r + 1)] == gaps[static_cast<size_t>(i - r)];
      to[i] = whole ? static_cast<float>(value[i] + sum[static_cast<size_t>(i)] / all) : at_rim(value, known, f.nx, i, g, all);
    }
  }
  return out;
}

Field transposed(const Field& f) {
  Field out{f.ny, f.nx, std::vector<float>(f.value.size()), std::vector<std::uint8_t>(f.known.size())};
  constexpr int block = 32;
  for (int j0 = 0; j0 < f.ny; j0 += block)
    for (int i0 = 0; i0 < f.nx; i0 += block)
      for (int j = j0; j < std::min(j0 + block, f.ny); ++j)
        for (int i = i0; i < std::min(i0 + block, f.nx); ++i) {
          out.value[out.at(j, i)] = f.value[f.at(i, j)];
          out.known[out.at(j, i)] = f.known[f.at(i, j)];
        }
  return out;
}

Field regressed(const Field& f, const std::vector<double>& g) { return transposed(along_rows(transposed(along_rows(f, g)), g)); }

/// Regressed, and the regressions of what that left over added.
Field smoothed(const Field& f, const std::vector<double>& g) {
  Field out = regressed(f, g), left = f;
  for (int turn = 1; turn < turns; ++turn) {
    for (size_t c = 0; c < f.value.size(); ++c) left.value[c] = f.value[c] - out.value[c];
    left = regressed(left, g);
    for (size_t c = 0; c < f.value.size(); ++c) out.value[c] += left.value[c];
  }
  return out;
}

/// Cells as high as all around them, to the last bit: water made level.
std::vector<std::uint8_t> level_cells(const Field& f) {
  std::vector<std::uint8_t> level(f.value.size(), 0);
  for (int j = 1; j + 1 < f.ny; ++j)
    for (int i = 1; i + 1 < f.nx; ++i) {
      const float h = f.value[f.at(i, j)];
      bool all = true;
      for (int dj = -1; dj <= 1; ++dj)
        for (int di = -1; di <= 1; ++di) all = all && f.known[f.at(i + di, j + dj)] && f.value[f.at(i + di, j + dj)] == h;
      level[f.at(i, j)] = all;
    }
  return level;
}

}  // namespace

int contour_surface_reach(double tolerance) {
  if (tolerance <= 0.0) return 0;
  int cells = 1;
  for (const double sigma : sigmas) cells += turns * radius_of(sigma);
  return cells;
}

core::Grid contour_surface(core::Grid grid, double tolerance) {
  if (tolerance <= 0.0) return grid;
  const auto room = static_cast<float>(contour_surface_share * tolerance);
  Field given{grid.lattice.nx, grid.lattice.ny, grid.height, std::vector<std::uint8_t>(grid.height.size(), 1)};
  for (size_t c = 0; c < given.value.size(); ++c)
    if (std::isnan(given.value[c])) given.value[c] = 0.0F, given.known[c] = 0;
  const std::vector<std::uint8_t> level = level_cells(given);
  Field field = given;
  for (const double sigma : sigmas) {
    field = smoothed(field, kernel_of(sigma));
    for (size_t c = 0; c < field.value.size(); ++c)
      field.value[c] = level[c] ? given.value[c] : std::clamp(field.value[c], given.value[c] - room, given.value[c] + room);
  }
  for (size_t c = 0; c < field.value.size(); ++c)
    if (field.known[c]) grid.height[c] = field.value[c];
  return grid;
}

}  // namespace swath::terrain
