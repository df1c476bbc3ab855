// SPDX-License-Identifier: GPL-3.0-or-later
// Stands for the spring metaphor of Pingel, Clarke & McBride 2013 (a Laplace-like system over the whole raster, whose answer depends
// on its whole extent). Here every filled cell depends on values within reach + relax cells only, as tiles need. Start: linear
// interpolation along the four lines through the cell, weighted by the inverse product of the distances to the line's two ends; then a
// few Jacobi passes of the Laplace equation.
#include "filters/inpaint.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

namespace swath::filters {
namespace {

constexpr float nan_value = std::numeric_limits<float>::quiet_NaN();

/// The nearest value in one direction and its distance in steps; 0 steps where there is none within reach.
struct Sight {
  std::vector<float> value;
  std::vector<std::int16_t> steps;
};

/// Looks from every cell towards (-di, -dj), where (di, dj) is one of E, N, NE, NW ... ; one sweep.
Sight look(const Raster& r, int di, int dj, int reach) {
  Sight s{std::vector<float>(r.value.size(), nan_value), std::vector<std::int16_t>(r.value.size(), 0)};
  const int j_first = dj >= 0 ? 0 : r.ny - 1;
  const int j_step = dj >= 0 ? 1 : -1;
  const int i_first = di >= 0 ? 0 : r.nx - 1;
  const int i_step = di >= 0 ? 1 : -1;
  for (int nj = 0, j = j_first; nj < r.ny; ++nj, j += j_step)
    for (int ni = 0, i = i_first; ni < r.nx; ++ni, i += i_step) {
      if (!r.holds(i - di, j - dj)) continue;
      const size_t here = r.at(i, j);
      const size_t before = r.at(i - di, j - dj);
      if (!std::isnan(r.value[before])) {
        s.value[here] = r.value[before];
        s.steps[here] = 1;
      } else if (s.steps[before] > 0 && s.steps[before] < reach) {
        s.value[here] = s.value[before];
        s.steps[here] = static_cast<std::int16_t>(s.steps[before] + 1);
      }
    }
  return s;
}

struct Sums {
  std::vector<float> weight, value;
  explicit Sums(size_t n) : weight(n, 0.0F), value(n, 0.0F) {}
  void add(size_t c, float w, float v) {
    weight[c] += w;
    value[c] += w * v;
  }
};

void relax_once(Raster& r, const std::vector<size_t>& filled, std::vector<float>& fresh) {
  fresh.resize(filled.size());
  for (size_t k = 0; k < filled.size(); ++k) {
    const size_t c = filled[k];
    const int i = static_cast<int>(c % static_cast<size_t>(r.nx));
    const int j = static_cast<int>(c / static_cast<size_t>(r.nx));
    float sum = 0.0F;
    int n = 0;
    // Opposite neighbours count only together, so that a slope is not bent where one is missing.
    for (const auto& [di, dj] : {std::pair{1, 0}, std::pair{0, 1}}) {
      if (!r.holds(i - di, j - dj) || !r.holds(i + di, j + dj)) continue;
      const float a = r.value[r.at(i - di, j - dj)];
      const float b = r.value[r.at(i + di, j + dj)];
      if (std::isnan(a) || std::isnan(b)) continue;
      sum += a + b;
      n += 2;
    }
    fresh[k] = n > 0 ? sum / static_cast<float>(n) : r.value[c];
  }
  for (size_t k = 0; k < filled.size(); ++k) r.value[filled[k]] = fresh[k];
}

}  // namespace

Raster inpaint(const Raster& surface, const Inpainting& how) {
  struct Line {
    int di, dj;
    float step;
  };
  constexpr std::array<Line, 4> lines{{{1, 0, 1.0F}, {0, 1, 1.0F}, {1, 1, 1.41421356F}, {-1, 1, 1.41421356F}}};
  const size_t n = surface.value.size();
  Sums between(n);
  Sums single(how.extrapolate ? n : 0);
  for (const Line& line : lines) {
    const Sight back = look(surface, line.di, line.dj, how.reach);
    const Sight ahead = look(surface, -line.di, -line.dj, how.reach);
    for (size_t c = 0; c < n; ++c) {
      if (!std::isnan(surface.value[c])) continue;
      const float a = static_cast<float>(back.steps[c]) * line.step;
      const float b = static_cast<float>(ahead.steps[c]) * line.step;
      if (a > 0 && b > 0) {
        between.add(c, 1.0F / (a * b), (back.value[c] * b + ahead.value[c] * a) / (a + b));
      } else if (how.extrapolate && a + b > 0) {
        const float d = a + b;
        single.add(c, 1.0F / (d * d), a > 0 ? back.value[c] : ahead.value[c]);
      }
    }
  }
  Raster out = surface;
  std::vector<size_t> filled;
  for (size_t c = 0; c < n; ++c) {
    if (!std::isnan(surface.value[c])) continue;
    const Sums* sums = between.weight[c] > 0 ? &between : how.extrapolate && single.weight[c] > 0 ? &single : nullptr;
    if (!sums) continue;
    out.value[c] = sums->value[c] / sums->weight[c];
    filled.push_back(c);
  }
  std::vector<float> fresh;
  for (int pass = 0; pass < how.relax; ++pass) relax_once(out, filled, fresh);
  return out;
}

}  // namespace swath::filters
